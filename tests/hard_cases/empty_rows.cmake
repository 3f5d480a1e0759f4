# cmake -DROWS=folder -P empty_rows.cmake
file(REMOVE_RECURSE ${ROWS})
file(MAKE_DIRECTORY ${ROWS})
