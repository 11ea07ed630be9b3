# cmake --install: program, scenes, documents, man page, completion, and qp and tfeti as a CMake package; cpack -G DEB.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON) # what is installed is built by the target slipstick alone
set_target_properties(slipstick PROPERTIES INSTALL_RPATH_USE_LINK_PATH ON) # a deal.II outside of the system's folders

install(TARGETS slipstick RUNTIME)
install(DIRECTORY prm meshes DESTINATION ${CMAKE_INSTALL_DATADIR}/slipstick) # scenes find ../meshes
install(DIRECTORY doc/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/doc) # as in the repository: README links to doc/
install(FILES README.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
configure_file(packaging/slipstick.1.in slipstick.1 @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/slipstick.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES packaging/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME slipstick)

# The package. Its targets are written by hand: what the layers are built with (warnings, precompiled headers, deal.II's
# build types) is no affair of those who use them.
set(SLIPSTICK_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/slipstick)
foreach(layer base qp tfeti)
  install(DIRECTORY include/slipstick/${layer} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/slipstick)
endforeach()
install(TARGETS slipstick_base slipstick_tfeti ARCHIVE)
configure_package_config_file(cmake/slipstickConfig.cmake.in ${CMAKE_BINARY_DIR}/slipstickConfig.cmake
                              INSTALL_DESTINATION ${SLIPSTICK_PACKAGE_DIR}
                              PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/slipstickConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/slipstickConfig.cmake ${CMAKE_BINARY_DIR}/slipstickConfigVersion.cmake cmake/linker.cmake
        DESTINATION ${SLIPSTICK_PACKAGE_DIR})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME slipstick)
set(CPACK_PACKAGE_VENDOR slipstick)
set(CPACK_PACKAGE_CONTACT "slipstick maintainers <slipstick@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "frictional contact of elastic bodies by Total FETI")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON) # the libraries of the release that it is built on; needs dpkg-dev
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "openmpi-bin, libopenblas0")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
    "libdeal.ii-dev, libtrilinos-amesos2-dev, libtrilinos-tpetra-dev, libsuitesparse-dev, libeigen3-dev, paraview")
include(CPack)
