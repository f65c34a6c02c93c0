#include "format/code_tables.h"
namespace tessera {
const Parameters& default_parameters() {
    static const Parameters p = [] {
        Parameters q;
        q.fill(32);
        for (int i = 0; i < zero_parameters; ++i) {
            int nb = i % neighbour_classes, pos = (i / neighbour_classes) % position_classes;
            int v = 30 - pos + 3 * nb;
            q[i] = static_cast<std::uint8_t>(v < 4 ? 4 : v > 44 ? 44 : v);
        }
        for (int i = magnitude_offset; i < first_length_offset; ++i) q[i] = 27;
        for (int i = split_offset; i < parameter_count; ++i) q[i] = 30;
        return q;
    }();
    return p;
}
} // namespace tessera
