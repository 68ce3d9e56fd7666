/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "reports.h"

#include "boneAtlasRegistrationFilter.h"
#include "boneStatisticalModelEstimator.h"

namespace bone::python
{
namespace
{
using RegistrationType = AtlasRegistrationFilter<Mesh>;
using EstimatorType = StatisticalModelEstimator<Mesh>;

void
BindEstimator(py::module_ & m)
{
  auto estimator =
    AddFilter<EstimatorType>(m,
                             "StatisticalModelEstimator",
                             "Mean and principal modes of shape and density of subjects on one topology.\n\n"
                             "add_subject() for each; output: StatisticalModel.");
  estimator.def(
    "add_subject",
    [](EstimatorType & self, const std::string & name, Mesh * mesh) {
      HoldSource(self, "subject " + std::to_string(self.GetNumberOfSubjects()), mesh);
      self.AddSubject(name, mesh);
    },
    py::arg("name"),
    py::arg("mesh"),
    "Adds a mesh of the subjects' topology.");
  estimator.def("remove_subjects", &EstimatorType::RemoveSubjects);
  AddInput<StatisticalModel>(estimator,
                             "atlas",
                             BONE_PYTHON_INPUT(EstimatorType, Atlas),
                             "StatisticalModel that the subjects are added to; none: they are all there are.");
  AddParameters(estimator);
  AddOutput(
    estimator, "output", [](EstimatorType & self) { return self.GetOutput(); }, "StatisticalModel.");
  estimator.def_property_readonly(
    "subject_deviations",
    [](const EstimatorType & self) {
      py::list list;
      for (const SubjectDeviation & subject : self.GetSubjectDeviations())
      {
        py::dict entry;
        entry["name"] = subject.name;
        entry["shape"] = subject.shape;
        entry["density"] = subject.density;
        entry["outlier"] = subject.outlier;
        entry["used"] = subject.used;
        list.append(entry);
      }
      return list;
    },
    "For each subject a dict of name, shape (distance to the mean, mm), density (density units), outlier and used, "
    "after "
    "an update.");
}
} // namespace

void
BindAtlasFilters(py::module_ & m)
{
  BindEstimator(m);
  auto filter =
    AddFilter<RegistrationType>(m,
                                "AtlasRegistrationFilter",
                                "Carries a standard model to a subject: same topology, the subject's shape.\n\n"
                                "Inputs: standard, subject (DensityMesh). Output: DensityMesh without density.");
  AddInput<Mesh>(filter, "standard", BONE_PYTHON_INPUT(RegistrationType, Standard), "DensityMesh.");
  AddInput<Mesh>(filter, "subject", BONE_PYTHON_INPUT(RegistrationType, Subject), "DensityMesh.");
  filter.def(
    "set_subject_surface",
    [](RegistrationType & self, const Array<double> & points, const Array<IdType> & triangles) {
      TriangleSurface surface;
      surface.points = ToPoints(points, "points");
      surface.triangles = ToTriangles(triangles);
      self.SetSubjectSurface(surface);
    },
    py::arg("points"),
    py::arg("triangles"),
    "A closed surface as the subject, in place of a mesh: n x 3 (mm) and t x 3, counter-clockwise from outside.");
  AddParameters(filter);
  AddOutput(
    filter, "output", [](RegistrationType & self) { return self.GetOutput(); }, "DensityMesh.");
  AddReport(filter,
            "After an update: a dict of alignment (4 x 4, standard to subject), alignment_distance, surface_distance, "
            "subject_distance and layer_distance (mm), mirrored, and untangling.");
}
} // namespace bone::python
