#include "tools/verbs/quick_verbs.h"

namespace tessera {

std::span<const Verb> quick_verbs() {
    static const Verb verbs[] = {{"encode", add_encode_command},
                                 {"decode", add_decode_command},
                                 {"info", add_info_command},
                                 {"validate", add_validate_command},
                                 {"sheet", add_sheet_command}};
    return verbs;
}

} // namespace tessera
