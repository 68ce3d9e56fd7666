/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFiniteElementIO.h"

#include "boneIOError.h"
#include "boneTestBodies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace FiniteElementIOTests
{
using namespace bone;
using testing::HasSubstr;

FiniteElementModel
Model(ModulusField field)
{
  MeshArrays mesh = test::MakeTube({});
  test::SetDensity(mesh, 1, [](const Vector3 & x) { return 0.3 + 0.01 * x.z(); });
  mesh.quantity = DensityQuantity::AshGramPerCubicCentimetre;
  FiniteElementParameters parameters;
  parameters.modulusField = field;
  return MakeFiniteElements(mesh, FindElasticityLaw("keyak1998"), parameters);
}

std::string
TextOf(const std::string & path)
{
  std::ifstream file(path);
  return { std::istreambuf_iterator<char>(file), {} };
}

TEST(FiniteElementIO, EveryFormatNamesTheLawAndItsSource)
{
  const auto model = Model(ModulusField::Bins);
  for (const auto format : { FiniteElementFormat::Abaqus,
                             FiniteElementFormat::CalculiX,
                             FiniteElementFormat::FEBio,
                             FiniteElementFormat::Gmsh })
  {
    const std::string path = testing::TempDir() + "/model" + FiniteElementExtension(format);
    WriteFiniteElements(model, format, path);
    const std::string text = TextOf(path);
    EXPECT_THAT(text, HasSubstr("keyak1998"));
    EXPECT_THAT(text, HasSubstr("J. H. Keyak"));
    EXPECT_THAT(text, HasSubstr("mm, N, MPa, t/mm^3"));
    std::filesystem::remove(path);
  }
}

TEST(FiniteElementIO, AFileOfASolverHoldsNoStep)
{
  const std::string path = testing::TempDir() + "/model.inp";
  WriteFiniteElements(Model(ModulusField::Bins), FiniteElementFormat::CalculiX, path);
  EXPECT_EQ(TextOf(path).find("*STEP"), std::string::npos);
  std::filesystem::remove(path);
}

TEST(FiniteElementIO, RefusesAnotherExtensionAndModuliThatTheFormatCannotHold)
{
  const std::string path = testing::TempDir() + "/refused";
  EXPECT_THROW(WriteFiniteElements(Model(ModulusField::Bins), FiniteElementFormat::Gmsh, path + ".inp"), IOError);
  for (const auto & [format, field] : { std::pair(FiniteElementFormat::Abaqus, ModulusField::Cells),
                                        std::pair(FiniteElementFormat::CalculiX, ModulusField::Cells),
                                        std::pair(FiniteElementFormat::FEBio, ModulusField::Nodes) })
  {
    const std::string file = path + FiniteElementExtension(format);
    EXPECT_FALSE(HoldsModulusField(format, field));
    EXPECT_THROW(WriteFiniteElements(Model(field), format, file), std::invalid_argument);
    EXPECT_FALSE(std::filesystem::exists(file));
  }
}
} // namespace FiniteElementIOTests
