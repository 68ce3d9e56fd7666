/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityCalibrationFilter_h
#define boneDensityCalibrationFilter_h

#include "boneDensityCalibration.h"
#include "boneDensityCalibrationParameters.h"
#include "boneMeshFilter.h"
#include "boneReferenceRegion.h"

#include <itkImage.h>

#include <optional>
#include <variant>

namespace bone
{
/** A material of known density, and where its value comes from. */
struct DensityReference
{
  /** A value in HU as it is known, a rod or ball in the image, or a label of the label map: rods of a phantom, or
   * tissues of the patient. */
  using Measure = std::variant<double, ReferenceRegion, int>;

  std::string name;
  double      density{ 0.0 }; ///< known, in the unit that the references lead to
  Measure     measure;

  bool
  operator==(const DensityReference & other) const
  {
    return name == other.name && density == other.density && measure == other.measure;
  }
};

/** \class DensityCalibrationFilter
 * \brief Turns a density model in Hounsfield units into one in mineral, ash or apparent density.
 *
 * Inputs: the mesh (primary, "Mesh"), with a density; "Image", optional: the CT in which references are measured as
 * rods or labels; "Labels", optional: a label map on the grid of "Image". Output: the mesh with its density converted.
 *
 * First comes a line, density = intercept + slope HU: the one that was given (Line), or the least-squares line through
 * references (SetReferences); Quantity says what it leads to. Then come published laws by name, in order (SetLaws, \ref
 * PublishedDensityLaws). The line or the laws may be left out. All are linear in the density, which takes a Bernstein
 * polynomial to one of the same degree, exactly; so a CT that was calibrated before the fit gives the same model.
 *
 * Every mesh carries its quantity and unit. A law that starts from another quantity than the mesh's is refused.
 *
 * Throws itk::ExceptionObject without an input mesh or density, where there is nothing to apply, where quantities do
 * not match, where a line and references are both given, a reference holds no voxel or needs an input that is missing,
 * or references make no rising line. */
template <typename TImage = itk::Image<float, 3>,
          typename TMesh = DensityMesh<double>,
          typename TLabelImage = itk::Image<short, 3>>
class DensityCalibrationFilter : public MeshFilter<TMesh>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(DensityCalibrationFilter);
  using Self = DensityCalibrationFilter;
  using Superclass = MeshFilter<TMesh>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(DensityCalibrationFilter, MeshFilter);

  using ImageType = TImage;
  using LabelImageType = TLabelImage;

  itkSetInputMacro(Image, TImage);
  itkGetInputMacro(Image, TImage);
  itkSetInputMacro(Labels, TLabelImage);
  itkGetInputMacro(Labels, TLabelImage);

  BONE_FILTER_PARAMETERS(DensityCalibrationParameters, BONE_DENSITY_CALIBRATION_PARAMETERS)

  /** Line and Quantity in one call. Takes the place of references. */
  void
  SetLine(double intercept, double slope, DensityQuantity to);
  /** References, through which the line is fitted, and Quantity; none: no line. Takes the place of a given line. */
  void
  SetReferences(const std::vector<DensityReference> & references, DensityQuantity to);
  itkGetConstReferenceMacro(References, std::vector<DensityReference>);
  /** Names of published laws, applied in this order after the line. */
  void
  SetLaws(const std::vector<std::string> & names);
  itkGetConstReferenceMacro(Laws, std::vector<std::string>);

  /** \name Results of the last run
   * \{ */
  /** The line through the references, with residuals; empty where there were none. */
  itkGetConstReferenceMacro(Calibration, std::optional<Calibration>);
  /** A law that was applied, and the share of the volume whose mean density lay outside its range. */
  struct Step
  {
    DensityLaw law;
    double     outside;
  };
  itkGetConstReferenceMacro(Steps, std::vector<Step>);
  /** \} */

protected:
  DensityCalibrationFilter();
  ~DensityCalibrationFilter() override = default;

  void
  VerifyPreconditions() const override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  CalibrationReference
  Measure(const DensityReference & reference, const Execution & execution) const;
  std::vector<DensityLaw>
  CollectLaws(const Execution & execution);

  std::vector<DensityReference> m_References;
  std::vector<std::string>      m_Laws;
  std::optional<Calibration>    m_Calibration;
  std::vector<Step>             m_Steps;
};

extern template class DensityCalibrationFilter<itk::Image<float, 3>, DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneDensityCalibrationFilter.hxx"
#endif

#endif
