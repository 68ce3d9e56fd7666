/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "projector.h"

#include "failure.h"
#include "parameter_table.h"

#include <cmath>

namespace bone::python
{
PoseParameters::PoseParameters(const Eigen::Matrix<double, 6, 1> & numbers, const Vector3 & centre)
{
  const Vector3 r = numbers.tail<3>();
  const double  angle = r.norm();
  m_Pose.centre = centre;
  m_Pose.translation = numbers.head<3>();
  Eigen::Matrix3d cross;
  cross << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  // exp(r + dr) = exp(r) exp(J dr), J the right Jacobian.
  const bool            small = angle < 1e-4;
  const double          first = small ? 0.5 - angle * angle / 24 : (1 - std::cos(angle)) / (angle * angle);
  const double          second = small ? 1.0 / 6 - angle * angle / 120 : (angle - std::sin(angle)) / std::pow(angle, 3);
  const Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity() - first * cross + second * cross * cross;
  m_Pose.rotation = angle > 0 ? Eigen::AngleAxisd(angle, r / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
  m_Chain.setZero();
  m_Chain.topLeftCorner<3, 3>() = m_Pose.rotation;
  m_Chain.bottomRightCorner<3, 3>() = jacobian.transpose();
}

Projector::Projector(const Mesh &                 mesh,
                     const DRRParameters &        regions,
                     const RadiographParameters & conversion,
                     bool                         keep)
  : m_Arrays(mesh.GetArrays())
  , m_Parameters(MakeMeshRadiographParameters(regions.minimumRegion,
                                              regions.maximumRegion,
                                              conversion.huToAttenuation,
                                              conversion.waterAttenuation))
  , m_Centre(Vector3::Zero())
{
  const std::string obstacle = FindObstacle(m_Arrays.points, m_Arrays, m_Parameters, conversion.huToAttenuation);
  if (!obstacle.empty())
  {
    throw DataFailure(obstacle);
  }
  for (const Vector3 & x : m_Arrays.points)
  {
    m_Centre += x / static_cast<double>(m_Arrays.points.size());
  }
  m_Model = std::make_unique<ProjectionModel>(m_Arrays.points, m_Arrays, m_Parameters, Execution(), keep);
}

namespace
{
std::vector<py::ssize_t>
ShapeOf(const XRayGeometry::View & view)
{
  return { view.size[1], view.size[0] };
}
} // namespace

py::array_t<float>
Projector::Project(const XRayGeometry & geometry, const std::vector<PoseParameters> & poses) const
{
  std::vector<XRayGeometry::View> views;
  for (const PoseParameters & pose : poses)
  {
    views.push_back(pose.GetPose().ToModelSpace(geometry.GetView()));
  }
  const auto           shape = ShapeOf(geometry.GetView());
  py::array_t<float>   all({ static_cast<py::ssize_t>(poses.size()), shape[0], shape[1] });
  std::vector<float *> images;
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    images.push_back(all.mutable_data() + i * static_cast<std::size_t>(shape[0] * shape[1]));
  }
  const py::gil_scoped_release release;
  ProjectMesh(*m_Model, views, Execution(), images);
  return all;
}

py::tuple
Projector::Derive(const XRayGeometry & geometry, const PoseParameters & pose, RadiographModes modes) const
{
  const auto        view = pose.GetPose().ToModelSpace(geometry.GetView());
  const std::size_t count = modes.Count();
  const auto        pixels = static_cast<std::size_t>(view.size[0]) * static_cast<std::size_t>(view.size[1]);
  modes.poseCentre = pose.GetPose().centre;
  py::array_t<float>   image(ShapeOf(view));
  py::array_t<float>   derivatives({ static_cast<py::ssize_t>(count), ShapeOf(view)[0], ShapeOf(view)[1] });
  std::vector<float *> images{ image.mutable_data() };
  for (std::size_t k = 0; k < count; ++k)
  {
    images.push_back(derivatives.mutable_data() + k * pixels);
  }
  {
    const py::gil_scoped_release release;
    ProjectMeshDerivatives(*m_Model, view, modes, Execution(), images);
    if (modes.pose)
    {
      using Map = Eigen::Map<Eigen::Matrix<float, 6, Eigen::Dynamic, Eigen::RowMajor>>;
      Map                              rows(images[1], 6, static_cast<Eigen::Index>(pixels));
      const Eigen::Matrix<float, 6, 6> chain = pose.GetChain().cast<float>();
      if (!chain.isIdentity(0.0F))
      {
        Execution().For(
          pixels,
          [&](std::size_t i) {
            const auto                       column = static_cast<Eigen::Index>(i);
            const Eigen::Matrix<float, 6, 1> own = rows.col(column);
            rows.col(column) = chain * own;
          },
          4096);
      }
    }
  }
  return py::make_tuple(image, derivatives);
}

py::dict
Projector::Backproject(const XRayGeometry::View & stated, const PoseParameters & pose, const Array<float> & image) const
{
  const auto view = pose.GetPose().ToModelSpace(stated);
  if (image.ndim() != 2 || image.shape(0) != view.size[1] || image.shape(1) != view.size[0])
  {
    throw UsageFailure("the image must have the radiograph's " + std::to_string(view.size[1]) + " x " +
                       std::to_string(view.size[0]) + " pixels");
  }
  const auto          count = static_cast<py::ssize_t>(m_Arrays.points.size());
  const auto          rows = static_cast<py::ssize_t>(m_Arrays.tetrahedra.size());
  py::array_t<double> points({ count, py::ssize_t{ 3 } });
  py::array_t<double> coefficients({ rows, static_cast<py::ssize_t>(m_Arrays.coefficients.size()) / rows });
  auto * const        positions = reinterpret_cast<Vector3 *>(points.mutable_data());
  double * const      numbers = coefficients.mutable_data();
  const float * const weights = image.data();

  Eigen::Matrix<double, 6, 1> motion = Eigen::Matrix<double, 6, 1>::Zero();
  {
    const py::gil_scoped_release release;
    BackprojectToMesh(*m_Model, view, Execution(), weights, numbers, positions);
    for (std::size_t p = 0; p < m_Arrays.points.size(); ++p)
    {
      motion.head<3>() += positions[p];
      motion.tail<3>() += (m_Arrays.points[p] - pose.GetPose().centre).cross(positions[p]);
    }
    motion = pose.GetChain() * motion;
  }
  py::dict result;
  result["pose"] = motion;
  result["points"] = points;
  result["coefficients"] = coefficients;
  return result;
}

namespace
{
using SharedProjector = std::shared_ptr<Projector>;

SharedProjector
BuildProjector(const Mesh & mesh, bool keep, const py::kwargs & keywords)
{
  DRRParameters        regions;
  RadiographParameters conversion;
  for (const auto & item : keywords)
  {
    const auto name = item.first.cast<std::string>();
    if (!SetParameterByName(regions, name, item.second) && !SetParameterByName(conversion, name, item.second))
    {
      throw UsageFailure("a radiograph has no parameter \"" + name + '"');
    }
  }
  const py::gil_scoped_release release;
  return std::make_shared<Projector>(mesh, regions, conversion, keep);
}

Array<double>
ReadPoses(const py::object & poses)
{
  const auto array = Array<double>::ensure(poses);
  PyErr_Clear();
  return array;
}

PoseParameters
MakePose(const Projector & projector, const double * numbers, const py::object & centre)
{
  return { Eigen::Map<const Eigen::Matrix<double, 6, 1>>(numbers),
           centre.is_none() ? projector.GetCentre() : ToVector(centre, "pose_centre") };
}

PoseParameters
ReadPose(const Projector & projector, const py::object & pose, const py::object & centre)
{
  constexpr double still[6] = {};
  if (pose.is_none())
  {
    return MakePose(projector, still, centre);
  }
  const auto array = ReadPoses(pose);
  if (!array || array.size() != 6)
  {
    throw UsageFailure("pose must be six numbers: translation (mm) and rotation vector (radians)");
  }
  return MakePose(projector, array.data(), centre);
}

/** One radiograph, or those of the rows of n x 6 poses. */
py::object
ProjectPoses(const Projector & self, const XRayGeometry & geometry, const py::object & pose, const py::object & centre)
{
  const auto array = pose.is_none() ? Array<double>() : ReadPoses(pose);
  if (!array || array.ndim() != 2)
  {
    return self.Project(geometry, { ReadPose(self, pose, centre) })[py::int_(0)];
  }
  if (array.shape(1) != 6)
  {
    throw UsageFailure("poses must be n x 6: translation (mm) and rotation vector (radians) of each");
  }
  std::vector<PoseParameters> poses;
  for (py::ssize_t i = 0; i < array.shape(0); ++i)
  {
    poses.push_back(MakePose(self, array.data(i, 0), centre));
  }
  return self.Project(geometry, poses);
}

py::tuple
DeriveModes(const Projector &                  self,
            const XRayGeometry &               geometry,
            const py::object &                 pose,
            const py::object &                 centre,
            bool                               withPose,
            const std::vector<Array<double>> & shape,
            const std::vector<Array<double>> & density)
{
  RadiographModes modes;
  modes.pose = withPose;
  for (const auto & mode : shape)
  {
    modes.shape.push_back(ToPoints(mode, "a shape mode"));
    if (modes.shape.back().size() != self.GetArrays().points.size())
    {
      throw UsageFailure("a shape mode must have a displacement for each of the mesh's points");
    }
  }
  for (const auto & mode : density)
  {
    modes.density.emplace_back(mode.data(), mode.data() + mode.size());
    if (modes.density.back().size() != self.GetArrays().coefficients.size())
    {
      throw UsageFailure("a density mode must have a number for each of the mesh's coefficients");
    }
  }
  return self.Derive(geometry, ReadPose(self, pose, centre), std::move(modes));
}

py::tuple
ValueAndPullback(const SharedProjector & self,
                 const XRayGeometry &    geometry,
                 const py::object &      pose,
                 const py::object &      centre)
{
  const PoseParameters parameters = ReadPose(*self, pose, centre);
  const auto           view = geometry.GetView();
  return py::make_tuple(
    self->Project(geometry, { parameters })[py::int_(0)],
    py::cpp_function(
      [self, view, parameters](const Array<float> & image) { return self->Backproject(view, parameters, image); },
      py::arg("cotangent"),
      "Derivatives of sum(cotangent * radiograph): a dict of pose (6; per mm and radian), points (n x 3, per mm) and "
      "coefficients (m x k)."));
}
} // namespace

void
BindProjector(py::module_ & m)
{
  py::class_<Projector, SharedProjector>(
    m,
    "Projector",
    "Radiographs of one density mesh from many views and in many poses, with their derivatives.\n\n"
    "keep: keeps what does not depend on the view, some 200 bytes a tetrahedron; faster from the second radiograph on. "
    "Further keywords: the parameters of DRRImageFilter (minimum_region, hu_to_attenuation, ...).\n"
    "pose: six numbers, translation t (mm) and rotation vector r (radians) of the mesh before fixed views: "
    "x -> R(r) (x - pose_centre) + pose_centre + t; pose_centre is the mean of the points by default.")
    .def(py::init(&BuildProjector), py::arg("mesh"), py::arg("keep") = true)
    .def("__call__",
         &ProjectPoses,
         py::arg("geometry"),
         py::arg("pose") = py::none(),
         py::arg("pose_centre") = py::none(),
         "The radiograph: rows x columns line integrals, float32. pose may be n x 6, for n poses that are drawn at "
         "once on "
         "all threads: n x rows x columns, the same images as one at a time.")
    .def(
      "derivatives",
      &DeriveModes,
      py::arg("geometry"),
      py::arg("pose") = py::none(),
      py::kw_only(),
      py::arg("pose_centre") = py::none(),
      py::arg("by_pose") = true,
      py::arg("shape") = std::vector<Array<double>>(),
      py::arg("density") = std::vector<Array<double>>(),
      "The radiograph (rows x columns) and its derivatives (modes x rows x columns): by the six numbers of the pose, "
      "by shape modes (n x 3, mm, each) and density modes (m x k each), in one pass.")
    .def(
      "vjp",
      &ValueAndPullback,
      py::arg("geometry"),
      py::arg("pose") = py::none(),
      py::kw_only(),
      py::arg("pose_centre") = py::none(),
      "The radiograph, and a function that turns derivatives of a number by its pixels (rows x columns) into those by "
      "pose, points and coefficients.")
    .def_property_readonly(
      "centre", [](const Projector & self) { return FromVector(self.GetCentre()); }, "Mean of the points, mm.");
}
} // namespace bone::python

void
BindRadiograph(pybind11::module_ & m)
{
  bone::python::BindGeometry(m);
  bone::python::BindProjector(m);
}
