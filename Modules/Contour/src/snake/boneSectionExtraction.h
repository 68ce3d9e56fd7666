/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSectionExtraction_h
#define boneSectionExtraction_h

#include "boneExtractionParameters.h"
#include "boneOutlineContrast.h"
#include "boneSection.h"

namespace bone
{
/** Empty sections for a bone between the heights `low` and `high`: on the image's slices, or, for a `step` above 0, at
 * the largest even distance not above it with which the first and the last fall on `low` and `high`. Never off the
 * image.
 */
std::vector<Section>
PlaceSections(const SliceRange & slices, double low, double high, double step);

/** Empty sections through the whole image, on its slices, or `step` above 0 apart with one at the height `anchor`. */
std::vector<Section>
PlaceSectionsThrough(const SliceRange & slices, double anchor, double step);

/** The highest value of the CT in the pieces' bounding boxes; the search ends with a value that reaches `enough`. */
double
BrightestWithin(const std::vector<Section> & sections, const PlaneSource & planes, double enough);

/** What the CT has on both sides of the pieces' outer contours, within their slices. */
OutlineContrast
MeasureContrast(const std::vector<Section> & sections,
                const PlaneSource &          planes,
                const Vector2 &              pixel,
                const Execution &            execution);

/** Moves the periosteal contours of sections, as they come from a label, to the CT's edges within
 * `parameters.refineDistance`. A slice where that makes contours cross keeps those it had, and its report says so. */
void
RefineSections(std::vector<Section> &       sections,
               const PlaneSource &          planes,
               const Vector2 &              pixel,
               const ExtractionParameters & parameters,
               const Execution &            execution,
               ExtractionReport &           report);

/** \brief Follows contours from slice to slice (paper 2.1).
 *
 * `sections` are the slices to be filled, in order; those with pieces are where a person has drawn. \ref
 * SectionFollower finds which part of the other slices is that bone; snakes then draw its outlines to the edges:
 * gradient vector flow first where a person has drawn, within two pixels elsewhere. Contours that would cross are
 * joined and parted by their union's outline. The report tells where pieces join, touch other bones or end, and of
 * sudden changes and gaps.
 */
void
PropagateSections(std::vector<Section> &       sections,
                  const PlaneSource &          planes,
                  const Vector2 &              pixel,
                  const ExtractionParameters & parameters,
                  const Execution &            execution,
                  ExtractionReport &           report);

/** Drops what is short-lived, finds the inner layers and removes empty slices at both ends, from the report too. */
void
FinishSections(std::vector<Section> &       sections,
               const PlaneSource &          planes,
               const Vector2 &              pixel,
               const ExtractionParameters & parameters,
               const Execution &            execution,
               ExtractionReport &           report);
} // namespace bone

#endif
