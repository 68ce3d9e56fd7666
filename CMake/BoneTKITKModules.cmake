# ITK's modules that BoneTK is built on, for find_package and for itk-module.cmake.
set(BONETK_ITK_COMPONENTS
    ITKCommon ITKIOImageBase ITKIONIFTI ITKIOMeta ITKIOPNG ITKIOGDCM ITKIONRRD ITKImageGrid ITKImageFunction
    ITKImageIntensity ITKImageFeature ITKSmoothing ITKThresholding ITKDistanceMap ITKConnectedComponents
    ITKBinaryMathematicalMorphology ITKPath ITKTransform ITKGDCM ITKIOTransformBase ITKIOTransformInsightLegacy
    ITKOptimizersv4)
