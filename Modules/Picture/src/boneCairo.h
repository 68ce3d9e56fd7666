/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCairo_h
#define boneCairo_h

#include <cairo.h>

#include <memory>

namespace bone
{
/** \defgroup Cairo Objects of Cairo that end with their scope
 * \{ */
struct DestroySurface
{
  void
  operator()(cairo_surface_t * surface) const
  {
    cairo_surface_destroy(surface);
  }
};
struct DestroyContext
{
  void
  operator()(cairo_t * context) const
  {
    cairo_destroy(context);
  }
};
using CairoSurface = std::unique_ptr<cairo_surface_t, DestroySurface>;
using CairoContext = std::unique_ptr<cairo_t, DestroyContext>;
/** \} */
} // namespace bone

#endif
