/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRefuse_h
#define boneRefuse_h

#include "boneIOError.h"
#include "boneTypes.h"

#include <algorithm>
#include <new>
#include <sstream>
#include <vector>

namespace bone
{
/** The parts written one after another. */
template <typename... TParts>
std::string
Say(const TParts &... parts)
{
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/** Throws an itk::ExceptionObject that says the parts; a reader puts the file's name before it. */
template <typename... TParts>
[[noreturn]] void
Refuse(const TParts &... parts)
{
  throw itk::ExceptionObject(__FILE__, __LINE__, Say(parts...));
}

/** \name Limits of what is read, in mm: a kilometre, which nothing lies away from a scanner's origin, and a micrometre,
 * which no scanner of bones resolves. Beyond them a unit is mistaken, or a file damaged.
 * \{ */
constexpr double FarthestCoordinate = 1e6;
constexpr double SmallestExtent = 1e-3;

/** Throws where a coordinate of point number `id` is not finite or too far away. */
inline void
RequireSensible(const Vector3 & point, std::size_t id)
{
  if (!point.allFinite())
  {
    Refuse("point ", id, " has a coordinate that is not finite");
  }
  if (!(point.cwiseAbs().maxCoeff() <= FarthestCoordinate))
  {
    Refuse("point ",
           id,
           " has a coordinate of ",
           point.cwiseAbs().maxCoeff(),
           " mm, where a kilometre is the most: are its units mm?");
  }
}

/** Throws where all points lie within a micrometre. */
inline void
RequireExtent(const std::vector<Vector3> & points)
{
  const auto apart = [&](const Vector3 & p) { return (p - points.front()).cwiseAbs().maxCoeff() > SmallestExtent; };
  if (!points.empty() && std::none_of(points.begin(), points.end(), apart))
  {
    Refuse("all its points lie within ", SmallestExtent, " mm: are its units mm?");
  }
}
/** \} */

/** Runs action() and turns what ITK throws, and a lack of memory, into an IOError that names the file. */
template <typename TAction>
auto
NamingFile(const std::string & path, TAction && action)
{
  try
  {
    return action();
  }
  catch (const IOError &)
  {
    throw;
  }
  catch (const itk::MemoryAllocationError &)
  {
    throw IOError(path, "is damaged, or needs more memory than there is");
  }
  catch (const itk::ExceptionObject & error)
  {
    throw IOError(path, ErrorLine(error));
  }
  catch (const std::bad_alloc &)
  {
    throw IOError(path, "is damaged, or needs more memory than there is");
  }
}
} // namespace bone

#endif
