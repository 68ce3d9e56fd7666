/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourExtraction_h
#define boneContourExtraction_h

#include "boneBoneLayers.h"
#include "boneSnake.h"

namespace bone
{
/** Parameters of the extraction; lengths in mm, densities in the CT's units (HU). */
struct ExtractionParameters
{
  SnakeParameters snake;
  LayerParameters layers;
  double          edgeSmoothing{ 0.0 };     ///< Gaussian on the CT before edges are sought; 0: 0.5 pixel
  double          minimumSlope{ 40.0 };     ///< of an edge, HU/mm
  double          minimumArea{ 4.0 };       ///< of a contour
  double          boneThreshold{ 150.0 };   ///< what never reaches it is no bone
  double          refineDistance{ 0.0 };    ///< bound on the refinement of a label's outline
  double          followStep{ 1.0 };        ///< slices further apart are followed on planes between them too
  double          minimumVolume{ 60.0 };    ///< of a body apart from the rest
  bool            keepSmallPieces{ false }; ///< also what exists on one slice only, and smaller bodies
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

/** What happened on all slices, and what a person should know. */
struct ExtractionReport
{
  std::vector<SliceReport> slices;
  std::vector<std::string> warnings;
};

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

/** Empty sections for a bone between the heights `low` and `high`: on the image's slices, or, for a `step` above 0, at
 * the largest even distance not above it with which the first and the last fall on `low` and `high`. Never off the
 * image.
 */
std::vector<BoneSection>
PlaceSections(const SliceRange & slices, double low, double high, double step);

/** Empty sections through the whole image, on its slices, or `step` above 0 apart with one at the height `anchor`. */
std::vector<BoneSection>
PlaceSectionsThrough(const SliceRange & slices, double anchor, double step);

/** The highest value of the CT in the pieces' bounding boxes; the search ends with a value that reaches `enough`. */
double
BrightestWithin(const std::vector<BoneSection> & sections, const PlaneSource & planes, double enough);

/** Moves the periosteal contours of sections, as they come from a label, to the CT's edges within
 * `parameters.refineDistance`. A slice where that makes contours cross keeps those it had, and its report says so. */
void
RefineSections(std::vector<BoneSection> &   sections,
               const PlaneSource &          planes,
               const Vector2 &              pixel,
               const ExtractionParameters & parameters,
               const ParallelFor &          parallel,
               ExtractionReport &           report);

/** \brief Follows contours from slice to slice (paper 2.1).
 *
 * `sections` are the slices to be filled, in order; those with pieces are where a person has drawn. \ref BoneFollower
 * finds which part of the other slices is that bone; snakes then draw its outlines to the edges: gradient vector flow
 * first where a person has drawn, within two pixels elsewhere. Contours that would cross are joined and parted by their
 * union's outline. The report tells where pieces join, touch other bones or end, and of sudden changes and gaps.
 */
void
PropagateSections(std::vector<BoneSection> &   sections,
                  const PlaneSource &          planes,
                  const Vector2 &              pixel,
                  const ExtractionParameters & parameters,
                  const ParallelFor &          parallel,
                  ExtractionReport &           report);

/** Drops what is short-lived, finds the inner layers and removes empty slices at both ends, from the report too. */
void
FinishSections(std::vector<BoneSection> &   sections,
               const PlaneSource &          planes,
               const Vector2 &              pixel,
               const ExtractionParameters & parameters,
               const ParallelFor &          parallel,
               ExtractionReport &           report);
} // namespace bone

#endif
