#include "format/byte_source.h"

#include <algorithm>

namespace tessera {
namespace {

// The longest gap between ranges that merging should close by the rules of near_bytes, far_bytes
// and wasted_share.
std::uint64_t worthwhile_gap(std::span<const ReadRequest> requests) {
    std::uint64_t wanted = 0;
    for (const MergedRead& range : merge_reads(requests, 0, ~std::uint64_t{0}))
        wanted += range.length;
    std::vector<std::uint64_t> gaps;
    const std::vector<MergedRead> apart = merge_reads(requests, near_bytes, ~std::uint64_t{0});
    for (std::size_t i = 1; i < apart.size(); ++i)
        gaps.push_back(apart[i].offset - apart[i - 1].offset - apart[i - 1].length);
    std::ranges::sort(gaps);
    std::uint64_t longest = near_bytes, wasted = 0;
    for (const std::uint64_t gap : gaps) {
        wasted += gap;
        if (gap > far_bytes)
            break;
        if (wasted > wanted / wasted_share)
            return std::min(longest, gap - 1); // close all gaps of one length, or none of them
        longest = gap;
    }
    return longest;
}

} // namespace

std::vector<MergedRead> merge_reads(std::span<const ReadRequest> requests) {
    return merge_reads(requests, worthwhile_gap(requests), max_merged_bytes);
}

std::vector<MergedRead> merge_reads(std::span<const ReadRequest> requests, std::uint64_t near,
                                    std::uint64_t longest) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < requests.size(); ++i)
        if (!requests[i].out.empty())
            order.push_back(i);
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return requests[i].offset; });
    std::vector<MergedRead> merged;
    for (const std::size_t i : order) {
        const std::uint64_t begin = requests[i].offset, end = begin + requests[i].out.size();
        if (!merged.empty()) {
            MergedRead& last = merged.back();
            const std::uint64_t last_end = last.offset + last.length;
            const bool is_near = begin <= last_end || begin - last_end <= near;
            const std::uint64_t joined = std::max(end, last_end) - last.offset;
            if (end <= last_end || (is_near && joined <= longest)) {
                last.length = joined;
                last.requests.push_back(i);
                continue;
            }
        }
        merged.push_back({begin, end - begin, {i}});
    }
    return merged;
}

} // namespace tessera
