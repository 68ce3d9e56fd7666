# The packages that BoneTK is built on beside ITK, and that its users need too. VTK looks for C libraries: the project that
# includes this enables C beside C++.
find_package(VTK 9.1 REQUIRED COMPONENTS CommonCore CommonDataModel IOXML IOGeometry FiltersCore ImagingStencil)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(nlohmann_json REQUIRED)
find_package(HDF5 REQUIRED COMPONENTS C CXX)
find_package(Boost REQUIRED)
find_package(DCMTK REQUIRED CONFIG)
find_package(PNG REQUIRED)
find_package(Threads REQUIRED)
