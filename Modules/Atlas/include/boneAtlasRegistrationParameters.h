/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAtlasRegistrationParameters_h
#define boneAtlasRegistrationParameters_h

#include "boneAlignmentKind.h"

namespace bone
{
/** How interior points follow the exterior surface. */
enum class InteriorRule : int
{
  Harmonic = 0,  ///< what the affine alignment leaves is a displacement that solves Laplace's equation
  EigenFrame = 1 ///< the paper's: same coordinates in the eigenvectors' frame of the nearest exterior points
};

/** How the exterior surface is deformed. */
enum class DeformationMethod : int
{
  AdaptiveFocus = 0, ///< the paper's
  NonRigidICP = 1    ///< optimal-step non-rigid ICP, for comparison
};

/** Whether a subject may be the mirror image of the standard model (a left bone of a right one). */
enum class MirrorMode : int
{
  Never = 0,
  Always = 1,
  Try = 2 ///< both are aligned; the nearer one is taken
};

template <>
struct ParameterChoices<InteriorRule>
{
  static constexpr std::array<const char *, 2> names = { "harmonic", "frames" };
};
template <>
struct ParameterChoices<DeformationMethod>
{
  static constexpr std::array<const char *, 2> names = { "focus", "icp" };
};
template <>
struct ParameterChoices<MirrorMode>
{
  static constexpr std::array<const char *, 3> names = { "never", "always", "try" };
};

// clang-format off
#define BONE_ATLAS_REGISTRATION_PARAMETERS(value, flag) \
  value(AlignmentKind, alignment, Alignment, AlignmentKind::Affine, ParameterRange::Any(), "", "alignment", \
    "What the alignment may change: rigid, similarity (the size too) or affine") \
  value(MirrorMode, mirror, Mirror, MirrorMode::Never, ParameterRange::Any(), "", "mirror", \
    "Reflect subjects: never, always, or try what fits better") \
  value(DeformationMethod, method, Method, DeformationMethod::AdaptiveFocus, ParameterRange::Any(), "", "method", \
    "Deformation of the surface: adaptive focus (focus) or non-rigid ICP (icp)") \
  value(InteriorRule, interior, Interior, InteriorRule::Harmonic, ParameterRange::Any(), "", "interior", \
    "How interior points follow: harmonic or frames") \
  flag(fitLayers, FitLayers, true, "", \
    "Surfaces between layers are laid on the subject's") \
  value(double, exteriorBound, ExteriorBound, 0.5, ParameterRange::NotNegativeOrInfinite(), "mm", "exterior-bound", \
    "How far the repair of inverted tetrahedra may move exterior points")
// clang-format on

/** Parameters of AtlasRegistrationFilter. */
BONE_PARAMETER_STRUCT(AtlasRegistrationParameters, BONE_ATLAS_REGISTRATION_PARAMETERS);
} // namespace bone

#endif
