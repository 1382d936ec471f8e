# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` puts where, find_package(domewarp), and the Debian package.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# public_headers(ROOM FILES...): what a user of the room may include. VERIFY_INTERFACE_HEADER_SETS compiles each alone.
function(public_headers room)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/${room}/)
  target_sources(domewarp_${room} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/lib FILES ${ARGN})
  set_target_properties(domewarp_${room} PROPERTIES EXPORT_NAME ${room} VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  install(TARGETS domewarp_${room} EXPORT domewarp FILE_SET HEADERS COMPONENT development
    ARCHIVE COMPONENT development LIBRARY COMPONENT program NAMELINK_COMPONENT development)
endfunction()

public_headers(core errors.h files.h memory.h parallel.h progress.h raw_vector.h vectors.h)
public_headers(profile interval.h plot.h surface.h)
public_headers(transform batch.h image_map.h)
public_headers(mesh t_junctions.h topology.h weld.h)
public_headers(scene crossing.h image.h raster.h scene.h test_scenes.h view.h)
public_headers(refine edge_oracle.h error_bound.h isotropic.h levels.h picture_cull.h radial_ranges.h refine.h refined_mesh.h skips.h soup.h view_cull.h visible_region.h)
public_headers(gltf grid.h read.h survey.h write.h)
public_headers(render compare.h frame.h image_metrics.h lights.h pixel_judge.h rasterise.h ray_trace.h screen.h)
public_headers(audit inspect.h)
public_headers(convert bake.h batch.h batch_plan.h batch_row.h batch_summary.h convert.h display.h job.h live.h manifest.h record.h report.h)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/domewarp)
install(EXPORT domewarp NAMESPACE domewarp:: FILE domewarpTargets.cmake DESTINATION ${package_folder} COMPONENT development)
configure_package_config_file(domewarpConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/domewarpConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/domewarpConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/domewarpConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/domewarpConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT development)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/LICENSES/GPL-3.0-or-later.txt ${PROJECT_SOURCE_DIR}/README.md
  DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

# The public headers as a manual: target `manual`, warnings are errors.
find_package(Doxygen)
if(DOXYGEN_FOUND)
  set(headers)
  foreach(room core profile transform mesh scene refine gltf render audit convert)
    get_target_property(room_headers domewarp_${room} HEADER_SET)
    list(APPEND headers ${room_headers})
  endforeach()
  set(DOXYGEN_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/manual)
  set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
  set(DOXYGEN_EXTRACT_ALL YES)
  set(DOXYGEN_WARN_IF_INCOMPLETE_DOC NO) # parameters whose name says all need no sentence
  set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
  set(DOXYGEN_QUIET YES)
  set(DOXYGEN_STRIP_FROM_PATH ${PROJECT_SOURCE_DIR}/lib)
  set(DOXYGEN_USE_MDFILE_AS_MAINPAGE ${PROJECT_SOURCE_DIR}/README.md)
  doxygen_add_docs(manual ${headers} ${PROJECT_SOURCE_DIR}/README.md)
endif()
