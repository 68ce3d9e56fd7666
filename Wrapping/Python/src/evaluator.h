/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef evaluator_h
#define evaluator_h

#include "objects.h"

#include "boneDensityEvaluation.h"

namespace bone::python
{
/** Adds evaluate, gradient, locate and the picture of a notebook to DensityMesh. */
void
BindEvaluation(py::class_<Mesh, itk::SmartPointer<Mesh>, itk::DataObject> & mesh);
} // namespace bone::python

#endif
