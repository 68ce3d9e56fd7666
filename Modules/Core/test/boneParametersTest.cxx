/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneParameters.h"

#include <itkProcessObject.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace bone;

namespace ParametersTests
{
// clang-format off
#define BONE_TABLE_OF_THE_TEST(value, flag) \
  value(int, count, Count, 3, ParameterRange::Between(1, 8), "", "count", "How many") \
  value(double, length, Length, 0.5, ParameterRange::Length(), "mm", "length", "How long") \
  flag(dense, Dense, false, "dense", "Whether there are many")
// clang-format on
BONE_PARAMETER_STRUCT(ParametersOfTheTest, BONE_TABLE_OF_THE_TEST);

class ProcessOfTheTest : public itk::ProcessObject
{
public:
  using Self = ProcessOfTheTest;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  itkNewMacro(Self);
  itkTypeMacro(ProcessOfTheTest, ProcessObject);
  BONE_PLAIN_FILTER_PARAMETERS(ParametersOfTheTest, BONE_TABLE_OF_THE_TEST);

  using Superclass::GetMTime;
  void
  Verify() const
  {
    this->VerifyPreconditions();
  }
};

/** Whether a change of the process makes what it has computed out of date. */
template <typename TChange>
bool
IsOutOfDateAfter(ProcessOfTheTest & process, TChange change)
{
  const auto before = process.GetMTime();
  change(process);
  return process.GetMTime() > before;
}

TEST(Parameters, AnotherValueMakesTheFilterOutOfDateAndTheSameDoesNot)
{
  const auto process = ProcessOfTheTest::New();
  EXPECT_TRUE(IsOutOfDateAfter(*process, [](auto & p) { p.SetCount(4); }));
  EXPECT_FALSE(IsOutOfDateAfter(*process, [](auto & p) { p.SetCount(4); }));
  EXPECT_TRUE(IsOutOfDateAfter(*process, [](auto & p) { p.SetLength(0.25); }));
  EXPECT_TRUE(IsOutOfDateAfter(*process, [](auto & p) { p.DenseOn(); }));
  EXPECT_FALSE(IsOutOfDateAfter(*process, [](auto & p) { p.SetDense(true); }));
  EXPECT_TRUE(IsOutOfDateAfter(*process, [](auto & p) { p.DenseOff(); }));
}

TEST(Parameters, OtherParametersMakeTheFilterOutOfDateAndTheSameDoNot)
{
  const auto          process = ProcessOfTheTest::New();
  ParametersOfTheTest parameters;
  EXPECT_FALSE(IsOutOfDateAfter(*process, [&](auto & p) { p.SetParameters(parameters); }));
  parameters.length = 2.0;
  EXPECT_TRUE(IsOutOfDateAfter(*process, [&](auto & p) { p.SetParameters(parameters); }));
  EXPECT_EQ(process->GetLength(), 2.0);
  EXPECT_FALSE(IsOutOfDateAfter(*process, [&](auto & p) { p.SetParameters(parameters); }));
}

TEST(Parameters, AValueOutOfItsRangeIsRefusedByNameValueAndUnit)
{
  const auto process = ProcessOfTheTest::New();
  EXPECT_NO_THROW(process->Verify());
  process->SetLength(0.0);
  EXPECT_THAT([&] { process->Verify(); },
              testing::ThrowsMessage<itk::ExceptionObject>(testing::HasSubstr("Length is 0 mm, but must be")));
}

TEST(ParameterRange, HasItsEndsUnlessItIsOpen)
{
  EXPECT_TRUE(ParameterRange::Between(1, 8).Contains(1));
  EXPECT_TRUE(ParameterRange::Between(1, 8).Contains(8));
  EXPECT_FALSE(ParameterRange::Between(1, 8).Contains(0.999));
  EXPECT_FALSE(ParameterRange::Between(1, 8).Contains(8.001));
  EXPECT_FALSE(ParameterRange::Above(0, 1).Contains(0));
  EXPECT_TRUE(ParameterRange::Above(0, 1).Contains(1));
  EXPECT_FALSE(ParameterRange::Positive().Contains(0));
}

TEST(ParameterRange, HoldsNoNaNAndInfinityOnlyWhereThatIsAValue)
{
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(ParameterRange::Any().Contains(std::nan("")));
  EXPECT_FALSE(ParameterRange::NotNegative().Contains(infinity));
  EXPECT_TRUE(ParameterRange::NotNegativeOrInfinite().Contains(infinity));
  EXPECT_FALSE(ParameterRange::NotNegativeOrInfinite().Contains(-infinity));
}

TEST(ParameterRange, ALengthIsAtLeastAMicrometre)
{
  EXPECT_TRUE(ParameterRange::LengthOrZero().Contains(0));
  EXPECT_FALSE(ParameterRange::LengthOrZero().Contains(0.0009));
  EXPECT_TRUE(ParameterRange::LengthOrZero().Contains(0.001));
  EXPECT_FALSE(ParameterRange::Length().Contains(0));
}
} // namespace ParametersTests
