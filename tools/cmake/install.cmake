# The package: find_package(asperity [COMPONENTS ...]), pkg-config for the core, the command.
include(CMakePackageConfigHelpers)

set(ASPERITY_TOOLS_COMPONENTS io bake c)
set(ASPERITY_GL_COMPONENTS gl gl_compute gl_occlusion)
set(ASPERITY_MUJOCO_COMPONENTS mujoco)
set(ASPERITY_HAL_COMPONENTS transport drivers hid can serial usb urdf plugin)
set(ASPERITY_COMPONENTS ${ASPERITY_TOOLS_COMPONENTS} ${ASPERITY_GL_COMPONENTS} ${ASPERITY_MUJOCO_COMPONENTS}
    ${ASPERITY_HAL_COMPONENTS})
set(_config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/asperity)

# Core. Each component below has an export file of its own, so that find_package(asperity) asks for GLM and nothing else.
install(TARGETS asperity asperity_reproducible EXPORT asperity-core
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT asperity-core NAMESPACE asperity:: FILE asperity-core.cmake DESTINATION ${_config_dir})

foreach(_component ${ASPERITY_COMPONENTS})
  if(TARGET asperity_${_component})
    install(TARGETS asperity_${_component} EXPORT asperity-${_component}
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
            LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
            FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
    install(EXPORT asperity-${_component} NAMESPACE asperity:: FILE asperity-${_component}.cmake
            DESTINATION ${_config_dir})
  endif()
endforeach()

# For a message to people.
foreach(_kind TOOLS GL MUJOCO HAL)
  list(JOIN ASPERITY_${_kind}_COMPONENTS ", " ASPERITY_${_kind}_COMPONENTS)
endforeach()

# What find_dependency has to find before a component is used; the core needs GLM only.
set(ASPERITY_PACKAGES_io TinyGLTF nlohmann_json PNG TIFF JPEG OpenEXR)
set(ASPERITY_PACKAGES_bake Threads)
set(ASPERITY_PACKAGES_urdf tinyxml2)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/asperity-config.cmake.in
                              ${PROJECT_BINARY_DIR}/asperity-config.cmake INSTALL_DESTINATION ${_config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/asperity-config-version.cmake
                                 VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/asperity-config.cmake ${PROJECT_BINARY_DIR}/asperity-config-version.cmake
        DESTINATION ${_config_dir})

# Paths in the .pc file are relative to it, so that an installed tree can be moved.
set(_pkgconfig_dir ${CMAKE_INSTALL_DATADIR}/pkgconfig)
file(RELATIVE_PATH _pc_prefix ${CMAKE_INSTALL_PREFIX}/${_pkgconfig_dir} ${CMAKE_INSTALL_PREFIX})
configure_file(${CMAKE_CURRENT_LIST_DIR}/asperity.pc.in ${PROJECT_BINARY_DIR}/asperity.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/asperity.pc DESTINATION ${_pkgconfig_dir})
if(TARGET asperity_c)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/asperity_c.pc.in ${PROJECT_BINARY_DIR}/asperity_c.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/asperity_c.pc DESTINATION ${_pkgconfig_dir})
endif()

if(TARGET asperity_command)
  install(TARGETS asperity_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(FILES ${PROJECT_SOURCE_DIR}/tools/command/manual/asperity.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${PROJECT_SOURCE_DIR}/tools/command/manual/asperity.bash
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME asperity)
endif()
if(TARGET asperity_driver_host)
  # Found beside a program, in this folder below its prefix, or here; see child_process.cpp.
  install(TARGETS asperity_driver_host RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR})
endif()
if(TARGET asperity_conformance)
  install(TARGETS asperity_conformance RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
if(ASPERITY_BUILD_HAL)
  # The driver that a vendor copies.
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/hal/sample/ DESTINATION ${CMAKE_INSTALL_DATADIR}/asperity/sample)
  # Where udev looks for the rules of packages: below a prefix of /usr it takes effect by itself.
  install(FILES ${PROJECT_SOURCE_DIR}/hal/udev/70-asperity.rules DESTINATION lib/udev/rules.d)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
file(GLOB _schemas CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/reference/*.schema.json)
install(FILES ${_schemas} DESTINATION ${CMAKE_INSTALL_DATADIR}/asperity/schema)
