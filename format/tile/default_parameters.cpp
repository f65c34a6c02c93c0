// The default parameters, from the normative tables. They were fitted to files of the corpus by
// tests/regression/train_defaults.
#include "format/tile/code_tables.h"

namespace tessera {

const Parameters& default_parameters(DefaultSet set) {
    static const Parameters views = {
#include "format/tables/default_parameters.inc"
    };
    static const Parameters pictures = {
#include "format/tables/picture_parameters.inc"
    };
    return set == DefaultSet::pictures ? pictures : views;
}

} // namespace tessera
