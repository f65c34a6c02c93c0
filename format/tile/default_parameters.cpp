// The default parameters, from the normative table. They were fitted to files of the corpus by
// tests/regression/train_defaults.
#include "format/tile/code_tables.h"

namespace tessera {

const Parameters& default_parameters() {
    static const Parameters parameters = {
#include "format/tables/default_parameters.inc"
    };
    return parameters;
}

} // namespace tessera
