// One invocation: the size of the indirect dispatch of pass 5, in rows of 1,024 groups; and the
// counters are made ready for the next wave.
#include "buffers.glsl"

void tsr_size_dispatch() {
    uint items = min(tsr_work_word(uint(tsr_w_items)), tsr_header(tsr_b_items_room));
    // No more than the buffer holds, whatever the header says.
    items = min(items, uint(tsr_work.length()) / uint(tsr_item_words));
    tsr_set_work(uint(tsr_w_groups), min(items, 1024u));
    tsr_set_work(uint(tsr_w_groups) + 1u, min((items + 1023u) / 1024u, 65535u));
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
