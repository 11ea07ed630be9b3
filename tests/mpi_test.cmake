# add_mpi_test_executable(TARGET SOURCES file... LINKS target...): GoogleTest under MPI. What its files share (torn.h, main)
# is compiled once, and all sources as one unit: the headers of deal.II and Eigen cost more than the tests. Tests run for
# seconds, so that -O1 pays.
if(NOT TARGET slipstick_testing)
  add_library(slipstick_testing STATIC ${CMAKE_CURRENT_LIST_DIR}/mpi_main.cc ${CMAKE_CURRENT_LIST_DIR}/torn.cc)
  deal_ii_setup_target(slipstick_testing)
  target_include_directories(slipstick_testing PUBLIC ${CMAKE_CURRENT_LIST_DIR})
  target_link_libraries(slipstick_testing slipstick_interface slipstick_contact GTest::gtest)
  target_compile_options(slipstick_testing PUBLIC $<$<CONFIG:Release>:-O1>)
  target_precompile_headers(slipstick_testing PRIVATE ${CMAKE_CURRENT_LIST_DIR}/torn.h)
endif()

function(add_mpi_test_executable target)
  cmake_parse_arguments(ARGUMENT "" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${target} ${ARGUMENT_SOURCES})
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
  deal_ii_setup_target(${target})
  target_link_libraries(${target} slipstick_testing ${ARGUMENT_LINKS})
  target_precompile_headers(${target} REUSE_FROM slipstick_testing)
endfunction()

# add_mpi_tests(TARGET RANKS n... LABEL label): one ctest TARGET_n for every n; as root and with more ranks than
# cores too, not pinned, since ctest runs several at a time.
find_program(MPIRUN_EXECUTABLE mpirun REQUIRED)

function(add_mpi_tests target)
  cmake_parse_arguments(ARGUMENT "" "LABEL" "RANKS" ${ARGN})
  foreach(n_ranks ${ARGUMENT_RANKS})
    set(name ${target}_${n_ranks})
    add_test(NAME ${name} COMMAND ${CMAKE_SOURCE_DIR}/scripts/mpirun --shared-cores -n ${n_ranks} $<TARGET_FILE:${target}>)
    set_tests_properties(${name} PROPERTIES
      LABELS ${ARGUMENT_LABEL}
      PROCESSORS ${n_ranks}
      TIMEOUT ${SLIPSTICK_TEST_TIMEOUT}
      ENVIRONMENT "MPIEXEC=${MPIRUN_EXECUTABLE}")
  endforeach()
endfunction()
