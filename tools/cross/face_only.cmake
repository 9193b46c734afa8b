# The build with SULCUS_FACE_ONLY: from what the top folder has set up, with headers of the build
# machine that are the same for every system, copied so that none of its others are found.
set(headers ${PROJECT_BINARY_DIR}/headers)
file(COPY /usr/include/eigen3/Eigen /usr/include/eigen3/unsupported /usr/include/toml++
  /usr/include/xxhash.h DESTINATION ${headers})
if(EXISTS /usr/include/xxh3.h)
  file(COPY /usr/include/xxh3.h DESTINATION ${headers})
endif()

foreach(library Eigen3::Eigen PkgConfig::XXHASH PkgConfig::TOMLPLUSPLUS)
  add_library(${library} INTERFACE IMPORTED)
  target_include_directories(${library} SYSTEM INTERFACE ${headers})
endforeach()
target_compile_definitions(PkgConfig::XXHASH INTERFACE XXH_INLINE_ALL)
target_compile_definitions(sulcus_options INTERFACE SULCUS_STD_THREADS)
# GCC 12 takes what xxHash's inline code reads by NEON for unset.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL aarch64)
  target_compile_options(sulcus_options INTERFACE -Wno-maybe-uninitialized)
endif()

add_subdirectory(engine)
add_subdirectory(haptics)

# Prints the hashes of scenes: what tools/everywhere runs.
add_executable(sulcus_hashes tools/examples/hashes.c)
target_link_libraries(sulcus_hashes PRIVATE sulcus_shared)
set_target_properties(sulcus_hashes PROPERTIES
  RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR} C_STANDARD 11)
set_target_properties(sulcus_shared PROPERTIES
  RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR} ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})

install(TARGETS sulcus_shared sulcus_hashes COMPONENT library
  RUNTIME DESTINATION bin LIBRARY DESTINATION lib ARCHIVE DESTINATION lib PUBLIC_HEADER DESTINATION include)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION . COMPONENT library)
install(FILES ${PROJECT_SOURCE_DIR}/tools/examples/press.c ${PROJECT_SOURCE_DIR}/tools/examples/hashes.c
  DESTINATION examples COMPONENT library)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/tests/golden/ DESTINATION scenes COMPONENT library
  FILES_MATCHING PATTERN *.toml)
set(CPACK_GENERATOR ZIP)
set(CPACK_PACKAGE_NAME libsulcus)
include(CPack)
