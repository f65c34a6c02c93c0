# Libraries, headers, shaders, the CMake package and the pkg-config file.
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/tessera)
set(libraries tessera_format tessera_decoder tessera_codec)
if(TESSERA_SHARED)
    list(APPEND libraries tessera_shared)
endif()
install(TARGETS ${libraries} EXPORT tesseraTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT tesseraTargets NAMESPACE tessera:: DESTINATION ${package_folder})
install(DIRECTORY ${PROJECT_BINARY_DIR}/include/tessera DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

# A component of its own: it wants EGL and epoxy, which the codec does not.
if(TESSERA_GPU)
    install(TARGETS tessera_decoder_glsl EXPORT tesseraGlslTargets
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(EXPORT tesseraGlslTargets NAMESPACE tessera:: DESTINATION ${package_folder})
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/decoder_glsl/shaders/
            DESTINATION ${CMAKE_INSTALL_DATADIR}/tessera/shaders FILES_MATCHING PATTERN "*.glsl")
endif()

configure_file(tools/cmake/tesseraConfig.cmake.in tesseraConfig.cmake @ONLY)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/tesseraConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/tesseraConfig.cmake ${PROJECT_BINARY_DIR}/tesseraConfigVersion.cmake
        DESTINATION ${package_folder})

set(static_libraries "-ltessera_codec -ltessera_decoder -ltessera_format")
if(TESSERA_SHARED)
    set(pc_libraries "-ltessera")
    set(pc_private "")
else()
    set(pc_libraries "${static_libraries}")
    set(pc_private "-lstdc++ -lm -pthread")
endif()
configure_file(tools/cmake/tessera.pc.in tessera.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/tessera.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
