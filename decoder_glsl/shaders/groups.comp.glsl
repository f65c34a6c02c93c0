// One invocation after pass 4: sets the size of the indirect dispatch of pass 5, in rows of
// tsr_row_groups, and prepares the counters for the next wave.
#include "buffers.glsl"

void tsr_size_dispatch() {
    uint items = min(tsr_work_word(uint(tsr_w_items)), tsr_header(tsr_b_items_room));
    // The header of a damaged batch may claim more items than the buffer holds.
    items = min(items, uint(tsr_work.length()) / uint(tsr_item_words));
    uint row = uint(tsr_row_groups);
    tsr_set_work(uint(tsr_w_groups), min(items, row));
    tsr_set_work(uint(tsr_w_groups) + 1u, min((items + row - 1u) / row, 65535u));
    tsr_set_work(uint(tsr_w_groups) + 2u, 1u);
    tsr_set_work(uint(tsr_w_ready), items);
    tsr_set_work(uint(tsr_w_items), 0u);
    tsr_set_work(uint(tsr_w_wave), tsr_work_word(uint(tsr_w_wave)) + 1u);
}

#ifndef __cplusplus
layout(local_size_x = 1) in;
void main() {
    tsr_size_dispatch();
}
#endif
