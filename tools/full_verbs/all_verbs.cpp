#include "tools/full_verbs/all_verbs.h"

#include "tools/verbs/quick_verbs.h"

namespace tessera {

std::span<const Verb> all_verbs() {
    static const Verb verbs[] = {{"bake", add_bake_command},     {"encode", add_encode_command},
                                 {"decode", add_decode_command}, {"compare", add_compare_command},
                                 {"info", add_info_command},     {"validate", add_validate_command},
                                 {"sheet", add_sheet_command},   {"shaders", add_shaders_command},
                                 {"render", add_render_command}, {"bench", add_bench_command},
                                 {"rd", add_rd_command},         {"view", add_view_command},
                                 {"serve", add_serve_command}};
    return verbs;
}

} // namespace tessera
