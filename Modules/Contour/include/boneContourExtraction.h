/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourExtraction_h
#define boneContourExtraction_h

#include "boneContourStack.h"
#include "boneExecution.h"
#include "bonePlaneField.h"
#include "boneSnakeContourParameters.h"

#include <functional>
#include <string>
#include <vector>

namespace bone
{
/** The CT in the plane at a height (mm along the normal), at least over the box from `low` to `high` (plane
 * coordinates, mm) as far as the image goes. Safe to call from many threads. */
using PlaneSource = std::function<PlaneField(double height, const Vector2 & low, const Vector2 & high)>;

/** Heights of an image's slices along the stack's normal, mm. */
struct SliceRange
{
  double first{ 0.0 };
  double step{ 1.0 };
  int    count{ 0 };

  double
  Top() const
  {
    return first + (count - 1) * step;
  }
};

/** What happened on a slice. */
struct SliceReport
{
  double      height{ 0.0 };     ///< mm along the normal
  int         iterations{ 0 };   ///< of the snakes, summed over the slice's contours
  bool        converged{ true }; ///< all of them
  double      energy{ 0.0 };     ///< internal, summed
  double      support{ 1.0 };    ///< least share of a contour's points that found an edge
  std::string events;            ///< what happened, separated by semicolons; empty: nothing special
};

/** \brief How heights are told to a person: as the image's own where it was given in another place. */
struct ToldHeight
{
  double sign{ 1.0 }; ///< -1: the slices are in the other order
  double offset{ 0.0 };

  double
  operator()(double height) const
  {
    return sign * height + offset;
  }
};

/** What happened on all slices, and what a person should know. */
struct ExtractionReport
{
  ToldHeight               told;                 ///< in warnings and errors
  double                   brighterShare{ 1.0 }; ///< of the outline, see \ref OutlineContrast
  std::vector<SliceReport> slices;
  std::vector<std::string> warnings;
  std::vector<std::string> doubts; ///< those of the warnings that say that the input may be a wrong one
};

/** \brief A box of voxels in space: voxel (i, j, k) is centred at origin + direction * (i, j, k) .* spacing (mm). */
struct VoxelBox
{
  std::array<int, 3> size{ { 0, 0, 0 } };
  Vector3            origin{ Vector3::Zero() };
  Vector3            spacing{ Vector3::Ones() };
  Eigen::Matrix3d    direction{ Eigen::Matrix3d::Identity() };

  std::size_t
  Count() const
  {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
  }
};

/** A label's bounding box with a margin, and which of its voxels have the label. */
struct LabelVoxels
{
  VoxelBox                   box;
  std::vector<unsigned char> inside;      ///< box.Count() flags, the first axis fastest
  double                     low{ 0.0 };  ///< height of the label's lowest voxel along the frame's normal, mm
  double                     high{ 0.0 }; ///< and of its highest
};

/** An image's slices in the frame of the stack. */
struct SliceFrame
{
  Vector3            u{ Vector3::UnitX() };
  Vector3            v{ Vector3::UnitY() };
  Vector3            normal{ Vector3::UnitZ() };
  Vector2            origin{ Vector2::Zero() }; ///< of the buffer's first voxel, plane coordinates
  Vector2            pixel{ Vector2::Ones() };  ///< mm
  SliceRange         slices;
  std::array<int, 2> size{}; ///< pixels along u and v
};

/** \brief The work of SnakeContourFilter on plain data.
 *
 * `label` or `initial` may be null, not both. Fills the contours' frame, slices and open ends. Throws
 * std::runtime_error as the filter documents. */
void
ExtractContours(const SliceFrame &             frame,
                const PlaneSource &            planes,
                const LabelVoxels *            label,
                const ContourStack *           initial,
                const SnakeContourParameters & parameters,
                const Execution &              execution,
                ContourStack &                 contours,
                ExtractionReport &             report);
} // namespace bone

#endif
