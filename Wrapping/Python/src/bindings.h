/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bindings_h
#define bindings_h

#include <pybind11/pybind11.h>

/** \defgroup Bindings What each source adds to the Python module _bonetk
 * \{ */
void
BindCommands(pybind11::module_ & m);
void
BindImages(pybind11::module_ & m);
void
BindMesh(pybind11::module_ & m);
void
BindModels(pybind11::module_ & m);
void
BindFilters(pybind11::module_ & m);
void
BindRadiograph(pybind11::module_ & m);
/** \} */

#endif
