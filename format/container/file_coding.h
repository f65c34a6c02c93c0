// The coding parameters of an open file.
#pragma once

#include "format/container_reader.h"
#include "format/tile/coding_parameters.h"

namespace tessera {

// Reads section CODE and checks it against the header. Errors: invalid_file, without the file's name.
Result<CodingParameters> coding_of(const ContainerReader& file);

} // namespace tessera
