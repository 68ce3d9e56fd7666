/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneModelView_h
#define boneModelView_h

#include "boneProjectedCells.h"
#include "boneProjectionModel.h"

#include <functional>
#include <limits>

namespace bone
{
/** A range of pixels. */
struct PixelRange
{
  int firstColumn{ std::numeric_limits<int>::max() };
  int endColumn{ 0 };
  int firstRow{ std::numeric_limits<int>::max() };
  int endRow{ 0 };

  bool
  IsEmpty() const
  {
    return firstColumn >= endColumn || firstRow >= endRow;
  }
  void
  Include(const PixelRange & other)
  {
    firstColumn = std::min(firstColumn, other.firstColumn);
    endColumn = std::max(endColumn, other.endColumn);
    firstRow = std::min(firstRow, other.firstRow);
    endRow = std::max(endRow, other.endRow);
  }
};

/** Bands of so many rows: as many that their rows stay in the cache and the threads share them well. */
int
BandCount(int rows);

/** The band of each row, ascending, so that bands take about as long. */
std::vector<int>
ShareRows(const std::vector<std::size_t> & blocksOfRow, int bands);

/** \class ModelView
 * \brief The blocks of a model as a view sees them. */
class ModelView
{
public:
  enum class Path
  {
    None,    ///< not seen
    Kernel,  ///< wholly between source and detector
    General, ///< behind or near the source, or through the detector
  };

  ModelView(const ProjectionModel & model, const XRayGeometry::View & view);

  const ProjectionModel &
  Model() const
  {
    return m_Model;
  }
  const RayFrame &
  Rays() const
  {
    return m_Cells.Rays();
  }
  /** For cells of the general path. */
  const ProjectedCells &
  Cells() const
  {
    return m_Cells;
  }

  /** Where a block is seen; row: of its centre. */
  Path
  FindRange(const ProjectionModel::Blocks & blocks, std::size_t block, PixelRange & range, double & row) const;

  /** Appends the block's cells. */
  void
  CopyCells(const ProjectionModel::Blocks & blocks, std::size_t block, std::vector<std::int32_t> & cells) const;

  /** Calls kernel(run) for the chosen blocks, in order: once, or, where the model does not keep them, for some at a
   * time that are filled for it. */
  void
  Run(const ProjectionModel::Blocks &                               blocks,
      const std::vector<std::int32_t> &                             chosen,
      const std::function<void(const projection::BlockRun & run)> & kernel) const;

private:
  projection::BlockRun
  MakeRun(const ProjectionModel::Blocks & blocks) const;

  const ProjectionModel & m_Model;
  ProjectedCells          m_Cells;
};
} // namespace bone

#endif
