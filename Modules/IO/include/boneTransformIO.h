/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTransformIO_h
#define boneTransformIO_h

#include <itkSmartPointer.h>

#include <string>

namespace itk
{
template <typename>
class Euler3DTransform;
}

namespace bone
{
/** \brief Reads a rigid transform from an ITK transform file (.tfm, .txt), which ITK-SNAP and 3D Slicer write too.
 *
 * It maps points as the file says (ITK: x' = A (x - c) + t + c). Taken: one matrix-offset transform of three dimensions
 * (Euler3DTransform, VersorRigid3DTransform, AffineTransform, ...) whose matrix is a rotation within 1e-5. Throws
 * IOError: one line that names the file, what is wrong and what to do. */
itk::SmartPointer<itk::Euler3DTransform<double>>
ReadRigidTransform(const std::string & path);

/** Writes an ITK transform file (.tfm, .txt) of an Euler3DTransform; the whole file or none. */
void
WriteRigidTransform(const itk::Euler3DTransform<double> & transform, const std::string & path);
} // namespace bone

#endif
