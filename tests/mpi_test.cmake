# add_mpi_tests(TARGET RANKS n... LABEL label): one ctest TARGET_n for every n; they run as root and with more ranks
# than cores too, and are not pinned, since ctest runs several at a time.
find_program(MPIRUN_EXECUTABLE mpirun REQUIRED)

function(add_mpi_tests target)
  cmake_parse_arguments(ARGUMENT "" "LABEL" "RANKS" ${ARGN})
  foreach(n_ranks ${ARGUMENT_RANKS})
    set(name ${target}_${n_ranks})
    add_test(NAME ${name} COMMAND ${MPIRUN_EXECUTABLE} -n ${n_ranks} $<TARGET_FILE:${target}>)
    set_tests_properties(${name} PROPERTIES
      LABELS ${ARGUMENT_LABEL}
      PROCESSORS ${n_ranks}
      TIMEOUT ${SLIPSTICK_TEST_TIMEOUT}
      ENVIRONMENT "OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;OMPI_MCA_rmaps_base_oversubscribe=1;OMPI_MCA_hwloc_base_binding_policy=none;OMPI_MCA_mpi_yield_when_idle=1;OMP_NUM_THREADS=1;OPENBLAS_NUM_THREADS=1")
  endforeach()
endfunction()
