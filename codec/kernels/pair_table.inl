// Included behind kernels.inl where products of two frequencies are summed by one instruction.
namespace tessera {
namespace {

// With x = high * 2^11 + low, high fits 16 bits and low 11, and every basis value but DC's 2^15 fits
// 16 bits too, so one multiply-add instruction sums the products of two frequencies. DC's share of
// the result is exactly 2^4 times its coefficient before the last shift. Sizes with an odd factor
// above 3 reach 2^15 at other frequencies as well (n = 5, k = 4, x = 2); they use the portable loops.

constexpr int max_pairs = max_frequencies / 4; // of even, or of odd, frequencies above 0

std::int32_t packed(std::int32_t low, std::int32_t high) {
    return static_cast<std::int32_t>((static_cast<std::uint32_t>(low) & 0xFFFFu) |
                                     (static_cast<std::uint32_t>(high) << 16));
}

// Basis values in pairs: even[x][p] holds frequencies 4p + 2 and 4p + 4, odd[x][p] 4p + 1 and
// 4p + 3, next[p][x] 2p + 1 and 2p + 2; 0 beyond n.
struct PairTable {
    std::int32_t even[max_tile_side][max_pairs], odd[max_tile_side][max_pairs];
    alignas(32) std::int32_t next[max_frequencies / 2][max_tile_side];
    bool fits; // no value above 16 bits but DC's
};

struct PairTables {
    PairTable of[max_tile_side + 1];
    PairTables() {
        for (int n = 1; n <= max_tile_side; ++n) {
            const std::int32_t* b = basis(n);
            const int coded = n < max_frequencies ? n : max_frequencies;
            const auto at = [&](int k, int x) { return k < coded && x < n ? b[k * n + x] : 0; };
            of[n].fits = true;
            for (int i = n; i < coded * n; ++i)
                of[n].fits = of[n].fits && b[i] < 1 << basis_bits;
            for (int x = 0; x < max_tile_side; ++x) {
                for (int p = 0; p < max_pairs; ++p) {
                    of[n].even[x][p] = packed(at(4 * p + 2, x), at(4 * p + 4, x));
                    of[n].odd[x][p] = packed(at(4 * p + 1, x), at(4 * p + 3, x));
                }
                for (int p = 0; p < max_frequencies / 2; ++p)
                    of[n].next[p][x] = packed(at(2 * p + 1, x), at(2 * p + 2, x));
            }
        }
    }
};

const PairTable& pair_table(int n) {
    static const PairTables tables;
    return tables.of[n];
}

} // namespace
} // namespace tessera
