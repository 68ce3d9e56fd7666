/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFiniteElementPage_h
#define boneFiniteElementPage_h

#include "boneFiniteElementModel.h"
#include "boneMeshArrays.h"
#include "boneReportPage.h"

namespace bone
{
/** A page of a finite-element model: its law with source and range, counts, sets and the distribution of moduli, and
 * the density mesh it comes from with the landmarks. The caller adds warnings and provenance. */
ReportPage
MakeFiniteElementPage(const std::string &           name,
                      const FiniteElementModel &    model,
                      const MeshArrays &            mesh,
                      const std::vector<Landmark> & landmarks);
} // namespace bone

#endif
