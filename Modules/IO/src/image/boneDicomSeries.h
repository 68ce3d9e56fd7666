/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDicomSeries_h
#define boneDicomSeries_h

#include "boneDicomFile.h"

#include <string>
#include <vector>

namespace bone
{
/** The images of one series that have one size and one normal, ascending along it. */
using DicomSeries = std::vector<DicomHeader>;

/** The series to read among the DICOM files of a folder and of those in it.
 *
 * Scouts (localizers), images without a place and, beside a volume, single images are passed over, and so are files
 * that are copies of another; `notes` says so. `wanted` is the number, UID or description of a series; where it is
 * empty there must be one volume. Throws SeveralSeries where there are several, IOError where there is none, or two
 * different images lie at one place. */
DicomSeries
FindDicomSeries(const std::string & folder, const std::string & wanted, std::vector<std::string> & notes);
} // namespace bone

#endif
