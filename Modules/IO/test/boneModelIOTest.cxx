/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModelIO.h"

#include "boneMeshIO.h"
#include "boneTestFiles.h"
#include "boneTestMeshes.h"

#include <H5Cpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace ModelIOTests
{
using namespace bone;

PrincipalModes
Modes(Eigen::Index d, Eigen::Index k, double scale)
{
  PrincipalModes modes;
  modes.mean = Eigen::VectorXd::LinSpaced(d, 0.1, scale);
  modes.modes = Eigen::MatrixXd::Identity(d, k);
  modes.variances = Eigen::VectorXd::LinSpaced(k, 4.0, 1.0);
  modes.totalVariance = 6.0;
  return modes;
}

StatisticalModelContent
Content()
{
  StatisticalModelContent content;
  content.mean.points = { Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1), Vector3(1, 1, 1) };
  content.mean.tetrahedra = { { { 0, 1, 2, 3 } }, { { 1, 2, 3, 4 } } };
  content.mean.region = { 1, 2 };
  content.mean.layer = { 0, 0, 0, 0, 1 };
  content.mean.maximumDegree = 1;
  content.mean.degree = { 1, 1 };
  content.mean.quantity = DensityQuantity::HounsfieldUnit;
  content.mean.coefficients.assign(8, 0.0);
  content.shape = Modes(15, 3, 7.0);
  content.density = Modes(8, 2, 900.0);
  content.density.weights = Eigen::VectorXd::Constant(8, 2.0);
  content.density.block = Eigen::Matrix2d{ { 2.0, 1.0 }, { 1.0, 2.0 } };
  content.combined.vectors = Eigen::MatrixXd::Identity(5, 2);
  content.combined.variances = Eigen::Vector2d(3, 1);
  content.combined.shapeWeight = 12.0;
  content.similarity = true;
  content.subjects = { "first", "", "the third" };
  content.shapeScores = Eigen::MatrixXd::Identity(3, 3);
  content.densityScores = Eigen::MatrixXd::Constant(3, 2, 0.5);
  return content;
}

std::string
WriteModel(const std::string & path)
{
  auto model = StatisticalModel::New();
  model->SetContent(Content());
  WriteStatisticalModel(model, path);
  return path;
}
using ModelIO = bone::FileTest;

TEST_F(ModelIO, WhatWasWrittenIsRead)
{
  const auto   model = ReadStatisticalModel(WriteModel(Path("atlas.h5")));
  const auto & a = Content();
  const auto & b = model->GetContent();
  EXPECT_EQ(a.shape.mean, b.shape.mean);
  EXPECT_EQ(a.shape.modes, b.shape.modes);
  EXPECT_EQ(a.shape.variances, b.shape.variances);
  EXPECT_EQ(a.density.modes, b.density.modes);
  EXPECT_EQ(a.density.weights, b.density.weights);
  EXPECT_EQ(a.density.block, b.density.block);
  EXPECT_EQ(a.combined.vectors, b.combined.vectors);
  EXPECT_EQ(a.combined.shapeWeight, b.combined.shapeWeight);
  EXPECT_EQ(a.shapeScores, b.shapeScores);
  EXPECT_EQ(a.subjects, b.subjects);
  EXPECT_EQ(a.similarity, b.similarity);
  EXPECT_EQ(a.mean.tetrahedra, b.mean.tetrahedra);
  EXPECT_EQ(a.mean.region, b.mean.region);
  EXPECT_EQ(a.mean.layer, b.mean.layer);
  EXPECT_TRUE(b.mean.slice.empty());
  EXPECT_EQ(b.mean.maximumDegree, 1);
  EXPECT_EQ(b.mean.quantity, DensityQuantity::HounsfieldUnit);
}

/** The names, types and sizes that statismo 0.9 and scalismo look for. */
TEST_F(ModelIO, ShapeIsInTheStatismoLayout)
{
  const H5::H5File file(WriteModel(Path("atlas.h5")), H5F_ACC_RDONLY);
  const auto       sizes = [&file](const char * name) {
    const H5::DataSpace  space = file.openDataSet(name).getSpace();
    std::vector<hsize_t> dims(static_cast<std::size_t>(space.getSimpleExtentNdims()));
    space.getSimpleExtentDims(dims.data());
    return dims;
  };
  using testing::ElementsAre;
  EXPECT_THAT(sizes("/representer/points"), ElementsAre(3, 5));
  EXPECT_THAT(sizes("/representer/cells"), ElementsAre(4, 2));
  EXPECT_THAT(sizes("/model/mean"), ElementsAre(15));
  EXPECT_THAT(sizes("/model/pcaBasis"), ElementsAre(15, 3));
  EXPECT_THAT(sizes("/model/pcaVariance"), ElementsAre(3));
  EXPECT_THAT(sizes("/model/noiseVariance"), ElementsAre(1));
  EXPECT_THAT(sizes("/version/majorVersion"), ElementsAre());
  EXPECT_TRUE(file.openDataSet("/model/pcaBasis").getDataType() == H5::PredType::NATIVE_FLOAT);
  const H5::Attribute type = file.openGroup("/representer").openAttribute("datasetType");
  std::string         text;
  type.read(type.getStrType(), text);
  EXPECT_EQ(text, "VOLUME_MESH");
  float basis[15][3];
  file.openDataSet("/model/pcaBasis").read(basis, H5::PredType::NATIVE_FLOAT);
  EXPECT_EQ(basis[1][1], 1.0F);
  EXPECT_EQ(basis[0][1], 0.0F);
}

/** Two runs of the same training write the same bytes, whenever they are. */
TEST_F(ModelIO, NoObjectOfTheFileHasATime)
{
  const H5::H5File file(WriteModel(Path("atlas.h5")), H5F_ACC_RDONLY);
  std::size_t      objects = 0;
  const auto       visit = [](hid_t, const char * name, const H5O_info_t * info, void * count) -> herr_t {
    ++*static_cast<std::size_t *>(count);
    EXPECT_EQ(info->atime, 0) << name;
    EXPECT_EQ(info->mtime, 0) << name;
    EXPECT_EQ(info->ctime, 0) << name;
    EXPECT_EQ(info->btime, 0) << name;
    return 0;
  };
  H5Ovisit(file.getId(), H5_INDEX_NAME, H5_ITER_NATIVE, visit, &objects);
  EXPECT_GT(objects, 10u);
}

TEST_F(ModelIO, RefusesWhatIsNoModel)
{
  EXPECT_THROW(ReadStatisticalModel(Path("missing.h5")), IOError);
  std::ofstream(Path("text.h5")) << "no HDF5";
  EXPECT_THROW(ReadStatisticalModel(Path("text.h5")), IOError);
  const std::string path = WriteModel(Path("atlas.h5"));
  {
    H5::H5File file(path, H5F_ACC_RDWR);
    file.unlink("/bonetk/density/modes");
  }
  EXPECT_THROW(ReadStatisticalModel(path), IOError);
  auto model = StatisticalModel::New();
  EXPECT_THROW(WriteStatisticalModel(model, Path("empty.h5")), IOError);
  model->SetContent(Content());
  EXPECT_THROW(WriteStatisticalModel(model, Path("atlas.vtu")), IOError);
}

TEST_F(ModelIO, RefusesSizesThatTheFileCannotHold)
{
  for (const int dimensions : { 1, 2 })
  {
    const std::string path = WriteModel(Path("atlas.h5"));
    const char *      name = dimensions == 1 ? "/bonetk/shape/mean" : "/bonetk/shape/modes";
    {
      H5::H5File    file(path, H5F_ACC_RDWR);
      const hsize_t sizes[2] = { hsize_t{ 1 } << 40, 3 };
      file.unlink(name);
      file.createDataSet(name, H5::PredType::NATIVE_DOUBLE, H5::DataSpace(dimensions, sizes)); // nothing is written
    }
    EXPECT_THAT(ErrorOf([&] { ReadStatisticalModel(path); }), testing::HasSubstr("more than the file can hold"))
      << name;
  }
}

TEST_F(ModelIO, RefusesNamesBeyondTheFile)
{
  const std::string path = WriteModel(Path("atlas.h5"));
  std::string       bytes = ReadText("atlas.h5");
  const std::size_t heap = bytes.find(std::string("HEAP\0\0\0\0", 8));
  ASSERT_NE(heap, std::string::npos);
  bytes[heap + 15] = '\x40'; // the highest byte of the size of its data
  WriteText("atlas.h5", bytes);
  EXPECT_THAT(ErrorOf([&] { ReadStatisticalModel(path); }), testing::HasSubstr("damaged"));
}

TEST_F(ModelIO, RefusesAFileOfAnotherLengthThanItSays)
{
  const std::string path = WriteModel(Path("atlas.h5"));
  WriteText("atlas.h5", ReadText("atlas.h5") + "more");
  EXPECT_THAT(ErrorOf([&] { ReadStatisticalModel(path); }), testing::HasSubstr("damaged"));
}

TEST_F(ModelIO, RefusesIdsOutOfRange)
{
  const std::string path = WriteModel(Path("atlas.h5"));
  {
    H5::H5File file(path, H5F_ACC_RDWR);
    const int  ids[8] = { 0, 1, 2, 3, 1, 2, 3, 5 };
    file.openDataSet("/bonetk/tetrahedra").write(ids, H5::PredType::NATIVE_INT);
  }
  EXPECT_THROW(ReadStatisticalModel(path), IOError);
}
} // namespace ModelIOTests
