/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRegistrationPage_h
#define boneRegistrationPage_h

#include "boneCanvas.h"
#include "boneMeshArrays.h"
#include "boneReportPage.h"

namespace bone
{
/** A page of a registration: its figures (`report` of ReportRegistration), the pictures of the views (none for a CT),
 * and the bone where it was found. `name`: of the model; `command`: "register rigid". The caller adds warnings and
 * provenance. */
ReportPage
MakeRegistrationPage(const std::string &         name,
                     const std::string &         command,
                     const nlohmann::json &      report,
                     const std::vector<Canvas> & views,
                     const MeshArrays &          bone);
} // namespace bone

#endif
