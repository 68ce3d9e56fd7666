/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFilterCases.h"

#include <gtest/gtest.h>
#include <itkCommand.h>

#include <cmath>
#include <cstring>
#include <set>
#include <sstream>

// What every filter promises, whatever it does.

namespace bone
{
namespace test
{
namespace FilterContractTests
{
template <typename T>
void
Append(std::string & bytes, const T & value)
{
  bytes.append(reinterpret_cast<const char *>(&value), sizeof(T));
}

void
Append(std::string & bytes, const Mesh * mesh)
{
  const MeshArrays arrays = mesh->GetArrays();
  for (const Vector3 & p : arrays.points)
  {
    Append(bytes, std::array<double, 3>{ p.x(), p.y(), p.z() });
  }
  for (const Id4 & cell : arrays.tetrahedra)
  {
    Append(bytes, cell);
  }
  for (const double c : arrays.coefficients)
  {
    Append(bytes, c);
  }
}

/** Everything that an output holds, as bytes. */
std::string
BytesOf(const itk::DataObject * output)
{
  std::string bytes;
  if (const auto * mesh = dynamic_cast<const Mesh *>(output))
  {
    Append(bytes, mesh);
  }
  else if (const auto * hierarchy = dynamic_cast<const DensityHierarchy<Mesh> *>(output))
  {
    for (std::size_t level = 0; level < hierarchy->GetNumberOfLevels(); ++level)
    {
      Append(bytes, hierarchy->GetMesh(level));
    }
  }
  else if (const auto * stack = dynamic_cast<const ContourStack *>(output))
  {
    for (const ContourSlice & slice : stack->GetSlices())
    {
      for (const Contour & contour : slice.contours)
      {
        for (const Vector3 & p : contour.points)
        {
          Append(bytes, std::array<double, 3>{ p.x(), p.y(), p.z() });
        }
      }
    }
  }
  else if (const auto * transform =
             dynamic_cast<const RigidRadiographRegistration<Mesh>::DecoratedTransformType *>(output))
  {
    for (const double x : transform->Get()->GetParameters())
    {
      Append(bytes, std::array<double, 1>{ x });
    }
  }
  else if (const auto * thickness = dynamic_cast<const CorticalThicknessFilter<CTImage>::OutputType *>(output))
  {
    const CorticalThicknessMap & map = thickness->Get();
    for (std::size_t p = 0; p < map.thickness.size(); ++p)
    {
      Append(bytes, map.thickness[p]);
      Append(bytes, map.density[p]);
      Append(bytes, map.status[p]);
    }
  }
  else if (const auto * image = dynamic_cast<const CTImage *>(output))
  {
    const std::size_t pixels = image->GetBufferedRegion().GetNumberOfPixels();
    bytes.assign(reinterpret_cast<const char *>(image->GetBufferPointer()), pixels * sizeof(float));
  }
  else if (const auto * model = dynamic_cast<const StatisticalModel *>(output))
  {
    Append(bytes, model->GetContent().shape.GetDimension());
    const MeshArrays sample = model->Synthesize(Eigen::VectorXd::Ones(1));
    for (const Vector3 & p : sample.points)
    {
      Append(bytes, std::array<double, 3>{ p.x(), p.y(), p.z() });
    }
  }
  return bytes;
}

std::string
BytesOf(itk::ProcessObject & filter)
{
  std::string bytes;
  for (const auto & output : filter.GetOutputs())
  {
    bytes += BytesOf(output.GetPointer());
  }
  return bytes;
}

/** Another value of a parameter's type. */
template <typename T>
T
Another(const T & value)
{
  if constexpr (std::is_same_v<T, bool>)
  {
    return !value;
  }
  else if constexpr (std::is_enum_v<T>)
  {
    return static_cast<T>(static_cast<int>(value) == 0 ? 1 : 0);
  }
  else if constexpr (std::is_arithmetic_v<T>)
  {
    return static_cast<T>(!std::isfinite(static_cast<double>(value)) ? 1 : value > 0 ? value - 1 : value + 1);
  }
  else
  {
    T longer = value;
    longer.push_back({});
    return longer;
  }
}

/** The progress that a filter tells of. */
struct Progress
{
  explicit Progress(itk::ProcessObject * filter)
  {
    filter->AddObserver(itk::ProgressEvent(), [this, filter](const itk::EventObject &) {
      const float now = filter->GetProgress();
      falls = falls || now < last;
      last = now;
      steps.insert(now);
      if (stopAt <= now)
      {
        filter->AbortGenerateDataOn();
      }
    });
  }
  std::set<float> steps;
  float           last{ 0.0F };
  bool            falls{ false };
  float           stopAt{ 2.0F };
};

template <typename TCase>
class Filter : public testing::Test
{
protected:
  using FilterType = typename TCase::Filter;

  static typename FilterType::Pointer
  Make()
  {
    auto filter = FilterType::New();
    TCase::Connect(*filter, false);
    return filter;
  }

  /** One run to its end, by two threads, that tests share: runs are what takes time here. */
  struct Run
  {
    typename FilterType::Pointer filter{ Make() };
    Progress                     progress{ filter };
    std::string                  bytes;

    Run()
    {
      filter->SetNumberOfWorkUnits(2);
      filter->Update();
      filter->RemoveAllObservers();
      bytes = BytesOf(*filter);
    }
  };

  static Run &
  Reference()
  {
    static Run run;
    return run;
  }

  static std::string
  WhyItFails(itk::ProcessObject * filter)
  {
    try
    {
      filter->Update();
    }
    catch (const itk::ExceptionObject & error)
    {
      return error.GetDescription();
    }
    return "no failure";
  }

  /** Expects that the filter starts its work, and stops it there. */
  static void
  ExpectStart(itk::ProcessObject * filter)
  {
    Progress progress(filter);
    progress.stopAt = 0.0F;
    EXPECT_THROW(filter->Update(), itk::ProcessAborted);
    filter->RemoveAllObservers();
  }
};

using Cases = testing::Types<PhantomCase,
                             SnakeCase,
                             SliceCase,
                             ResampleCase,
                             AxisCase,
                             TilingCase,
                             QualityCase,
                             SmoothingCase,
                             SwapCase,
                             FitCase,
                             CalibrationCase,
                             ThicknessCase,
                             DensityImageCase,
                             CollapseCase,
                             LevelCase,
                             DRRCase,
                             DRROfViewCase,
                             DerivativeCase,
                             AdjointCase,
                             VoxelDRRCase,
                             AttenuationCase,
                             IntensityCase,
                             NoiseCase,
                             RegistrationCase,
                             PreprocessCase,
                             RigidCase,
                             DeformableCase,
                             VolumeCase,
                             EstimatorCase>;
TYPED_TEST_SUITE(Filter, Cases, );

TYPED_TEST(Filter, PrintsItsNameAndParameters)
{
  const auto         filter = this->Make();
  std::ostringstream text;
  filter->Print(text);
  EXPECT_NE(text.str().find(filter->GetNameOfClass()), std::string::npos);
  TypeParam::VisitSetters([&text](const std::string & name, const auto &, const auto &) {
    EXPECT_NE(text.str().find(name + ": "), std::string::npos) << name;
  });
  EXPECT_NE(dynamic_cast<typename TypeParam::Filter *>(filter->CreateAnother().GetPointer()), nullptr);
}

TYPED_TEST(Filter, NamesAnInputThatIsMissingOrNull)
{
  auto empty = TypeParam::Filter::New();
  EXPECT_NE(this->WhyItFails(empty), "no failure");
  auto filter = this->Make();
  TypeParam::Connect(*filter, true);
  const std::string why = this->WhyItFails(filter);
  EXPECT_NE(why.find(TypeParam::input), std::string::npos) << why;
  TypeParam::Connect(*filter, false);
  this->ExpectStart(filter);
}

TYPED_TEST(Filter, SettersMarkItModifiedOnChangeAlone)
{
  auto filter = this->Make();
  TypeParam::VisitSetters([&filter](const std::string & name, const auto & set, const auto & get) {
    const auto before = filter->GetMTime();
    set(*filter, get(*filter));
    EXPECT_EQ(filter->GetMTime(), before) << name << " set to what it was";
    const auto other = Another(get(*filter));
    set(*filter, other);
    EXPECT_GT(filter->GetMTime(), before) << name;
    EXPECT_EQ(get(*filter), other) << name;
  });
}

TYPED_TEST(Filter, RunsAgainAfterAChangeAlone)
{
  auto & filter = this->Reference().filter;
  int    starts = 0;
  filter->AddObserver(itk::StartEvent(), [&starts](const itk::EventObject &) { ++starts; });
  filter->Update();
  EXPECT_EQ(starts, 0);
  filter->Modified();
  this->ExpectStart(filter);
  EXPECT_EQ(starts, 1);
}

TYPED_TEST(Filter, ProgressRisesFromNoneToAll)
{
  const Progress & progress = this->Reference().progress;
  EXPECT_FALSE(progress.falls);
  EXPECT_NEAR(progress.last, 1.0F, 1e-4F);
  if (TypeParam::isLong)
  {
    EXPECT_GE(progress.steps.size(), 10U);
  }
}

TYPED_TEST(Filter, AnAbortLeavesItReusable)
{
  auto     filter = this->Make();
  Progress progress(filter);
  progress.stopAt = TypeParam::isLong ? 0.4F : 0.0F;
  EXPECT_THROW(filter->Update(), itk::ProcessAborted);
  progress.stopAt = 2.0F;
  progress.last = 0.0F;
  filter->Update();
  EXPECT_EQ(BytesOf(*filter), this->Reference().bytes);
}

TYPED_TEST(Filter, OneAndTwoThreadsGiveTheSame)
{
  auto filter = this->Make();
  filter->SetNumberOfWorkUnits(1);
  filter->Update();
  EXPECT_FALSE(BytesOf(*filter).empty());
  EXPECT_EQ(BytesOf(*filter), this->Reference().bytes);
}
} // namespace test
} // namespace FilterContractTests
} // namespace bone
