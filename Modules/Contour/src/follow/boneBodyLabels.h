/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBodyLabels_h
#define boneBodyLabels_h

#include "boneSnakeContourParameters.h"
#include "boneSection.h"

#include <functional>
#include <set>
#include <vector>

namespace bone
{
/** \class BodyTable
 * \brief Bodies by number, 1 and up, and which of them have become one. */
class BodyTable
{
public:
  explicit BodyTable(int count = 1);
  int
  New();
  int
  Find(int body) const;
  /** The lower number stands for both. */
  void
  Join(int a, int b);

private:
  std::vector<int> m_Parent;
};

/** How pixels become bodies; lengths in mm, densities in HU. */
struct BodyRules
{
  double threshold{ SnakeContourParameters().boneThreshold };        ///< bone lies above
  double softTissue{ 50.0 };                                         ///< what surrounds it
  double minimumArea{ SnakeContourParameters().minimumContourArea }; ///< of a new piece
  double closing{ 1.0 }; ///< gaps of the cortex up to twice as wide do not open it
};

/** Where two bodies touch in a connected part of bone on a slice. */
struct BodyContact
{
  int         a{ 0 }; ///< the lower number
  int         b{ 0 };
  double      length{ 0.0 };  ///< mm
  double      valley{ 0.0 };  ///< depth of the dark valley between them, integrated along it, HU mm
  double      sides{ 0.0 };   ///< height of the lower side above soft tissue, integrated likewise
  double      areaOfA{ 0.0 }; ///< in the part, mm^2
  double      areaOfB{ 0.0 };
  std::size_t pixelOfA{ 0 }; ///< where they touch
  std::size_t pixelOfB{ 0 };
};

/** \brief A slice's bodies, compressed by rows. */
class BodyRuns
{
public:
  /** Outlines of what belongs to the bodies chosen, at the pixels' sides, rounded off by 0.7 pixel. */
  std::vector<Polygon>
  OutlinesOf(const std::function<bool(int)> & chosen) const;

private:
  friend class BodyLabels;
  struct Run
  {
    int row;
    int begin;
    int end;
    int body;
  };
  PlaneGrid        m_Grid;
  std::vector<Run> m_Runs;
};

class Valleys;

/** \class BodyLabels
 * \brief The body that each pixel of a slice belongs to, 0 for none; see \ref SectionFollower for the rules. */
class BodyLabels
{
public:
  /** On a slice where pieces were drawn: they are body 1, as far as the image confirms it: a part of bone mostly drawn
   * is taken whole, of others what lies inside. All other bone begins new bodies. */
  static BodyLabels
  FromDrawing(const PlaneField &                plane,
              const std::vector<SectionPiece> & pieces,
              const BodyRules &                 rules,
              BodyTable &                       bodies);

  /** On the slice after the one of `before`. */
  static BodyLabels
  Continue(const PlaneField &         plane,
           const BodyLabels &         before,
           const BodyRules &          rules,
           BodyTable &                bodies,
           std::vector<BodyContact> & contacts);

  /** Gives the connected pixels of the body at a pixel to another body. */
  void
  Absorb(std::size_t pixel, int body);

  BodyRuns
  Compress() const;
  std::set<int>
  Bodies() const;
  bool
  Any(const std::function<bool(int)> & chosen) const;
  /** mm^2. */
  double
  Area(const std::function<bool(int)> & chosen) const;
  /** Share of the chosen bodies' pixels at which a plane is above the threshold. */
  double
  Overlap(const PlaneField & plane, double threshold, const std::function<bool(int)> & chosen) const;

private:
  explicit BodyLabels(const PlaneGrid & grid);

  void
  Part(const PlaneField &         plane,
       const BodyLabels &         before,
       const BodyRules &          rules,
       BodyTable &                bodies,
       std::vector<BodyContact> & contacts);
  void
  Contest(const PlaneField &               plane,
          const std::vector<std::size_t> & part,
          const BodyRules &                rules,
          std::vector<BodyContact> &       contacts);
  void
  AddContacts(const PlaneField &               plane,
              const std::vector<std::size_t> & part,
              const Valleys &                  valleys,
              const BodyRules &                rules,
              std::vector<BodyContact> &       contacts) const;
  void
  FillEnclosed(const BodyLabels & before, const BodyRules & rules);
  /** The labels that are certain to hold on: away from where bodies end, and further from other bodies. */
  std::vector<int>
  Cores() const;

  PlaneGrid        m_Grid;
  std::vector<int> m_Body;
};
} // namespace bone

#endif
