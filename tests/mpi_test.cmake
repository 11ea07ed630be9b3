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
