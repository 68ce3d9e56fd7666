/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePageData_h
#define bonePageData_h

#include "boneColor.h"
#include "boneContourStack.h"
#include "boneImageIO.h"
#include "boneJson.h"
#include "boneLandmarkIO.h"
#include "boneMeshArrays.h"
#include "boneStatisticalModel.h"
#include "boneXRayGeometry.h"

#include <string>
#include <vector>

namespace bone
{
/** \defgroup PageData What the report page's script draws, as JSON
 * Numbers are whole numbers of as few bytes as hold them, with a step and an offset, compressed by gzip and in base64.
 * The script's `arrays.js` reads them. Points are LPS, mm.
 * \{ */

/** Bytes as base64. */
std::string
ToBase64(const std::string & bytes);

/** Bytes compressed by gzip, the same for the same bytes. */
std::string
Gzip(const std::string & bytes);

/** Values rounded to offset + step * whole number. `delta`: 0, or each number is stored as its difference to the one
 * `delta` places before, as it is near to it. `offsets` are those of value 0, 1, ..., over and over. Throws
 * std::invalid_argument where a value is not finite, the step is not positive, or a number has more than 31 bits. */
nlohmann::json
PackNumbers(const std::vector<double> & values, double step, const std::vector<double> & offsets, std::size_t delta);

/** Whole numbers, not negative. */
nlohmann::json
PackIds(const std::vector<IdType> & ids, std::size_t delta);

/** A mesh by its name. Points are right to a 65,000th of its longest side; coefficients to half of `coefficientStep`,
 * in density units. */
nlohmann::json
PackLevel(const std::string & name, const MeshArrays & mesh, double coefficientStep);

/** A step by which a picture of the mesh's density cannot be told from the density itself: a 500th of the range of 98 %
 * of its coefficients, that is an error below a 4,000th on average. */
double
PictureStep(const MeshArrays & mesh);

/** A level of a model and its name. */
struct NamedMesh
{
  std::string        name;
  const MeshArrays * mesh;
};

/** The levels of a model, finest first, with contours and landmarks where there are any (`contours` may be null). Needs
 * one level at least. \param finest  the first level where it is packed already: \ref PackLevel by its \ref PictureStep
 */
nlohmann::json
PackModel(const std::vector<NamedMesh> & levels,
          const ContourStack *           contours,
          const std::vector<Landmark> &  landmarks,
          const nlohmann::json &         finest = nullptr);

/** The CT on every slice of a stack in grey, with the slice's contours: values within the window as a JPEG, pixels as
 * small as 600,000 of them allow, but not smaller than voxels. `titles`: one a slice. */
nlohmann::json
PackSlices(const CTImage *                  ct,
           const ContourStack &             stack,
           const Window &                   window,
           const std::string &              unit,
           const std::vector<std::string> & titles);

/** The mean and the first modes, at most `modes` of shape and of density each, as their change at +1 standard
 * deviation, and the view of the page's radiograph. */
nlohmann::json
PackAtlas(const StatisticalModel & model, std::size_t modes, const XRayGeometry::View & view);
/** \} */
} // namespace bone

#endif
