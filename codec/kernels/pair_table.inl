// Included after kernels.inl where one instruction sums the products of two frequencies.
namespace tessera {
namespace {

// Coefficients are split into x = high * 2^11 + low. high fits 16 bits, low 11, and every basis
// value except 2^15 fits 16 bits, so one multiply-add sums the products of two frequencies. Where
// the basis value is 2^15, the coefficient contributes exactly 2^4 times itself before the last
// shift and is called *whole*. DC always is, others are at a few positions in sizes with an odd
// factor (n = 5, k = 4, x = 2).

constexpr int max_pairs = max_frequencies / 4; // pairs of even (or odd) frequencies above 0

std::int32_t packed(std::int32_t low, std::int32_t high) {
    return static_cast<std::int32_t>((static_cast<std::uint32_t>(low) & 0xFFFFu) |
                                     (static_cast<std::uint32_t>(high) << 16));
}

// Basis values in pairs: even[x][p] holds frequencies 4p + 2 and 4p + 4, odd[x][p] 4p + 1 and 4p +
// 3, next[p][x] 2p + 1 and 2p + 2. They are 0 past n and where a coefficient is whole. Above DC
// only multiples of 4 can be whole: bit i of whole[x] stands for frequency 4i + 4.
struct PairTable {
    std::int32_t even[max_block_side][max_pairs], odd[max_block_side][max_pairs];
    alignas(32) std::int32_t next[max_frequencies / 2][max_block_side];
    std::uint8_t whole[max_block_side];
    std::uint8_t whole_anywhere; // the union of all whole[]
};

struct PairTables {
    PairTable of[max_block_side + 1];
    PairTables() {
        for (int n = 1; n <= max_block_side; ++n) {
            const std::int32_t* b = basis(n);
            const int coded = n < max_frequencies ? n : max_frequencies;
            const auto is_whole = [&](int k, int x) {
                return k < coded && x < n && b[k * n + x] == 1 << basis_bits;
            };
            const auto at = [&](int k, int x) {
                return k < coded && x < n && !is_whole(k, x) ? b[k * n + x] : 0;
            };
            of[n].whole_anywhere = 0;
            for (int x = 0; x < max_block_side; ++x) {
                of[n].whole[x] = 0;
                for (int k = 4; k < max_frequencies; k += 4)
                    of[n].whole[x] =
                        static_cast<std::uint8_t>(of[n].whole[x] | is_whole(k, x) << (k / 4 - 1));
                of[n].whole_anywhere =
                    static_cast<std::uint8_t>(of[n].whole_anywhere | of[n].whole[x]);
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

// The sine basis, whose values all fit 16 bits, in pairs: next[p][x] holds frequencies 2p and 2p + 1.
// They are 0 past n.
struct SinePairs {
    alignas(32) std::int32_t next[max_sine_side / 2][max_sine_side];
};

struct AllSinePairs {
    SinePairs of[max_sine_side + 1];
    AllSinePairs() {
        for (int n = 1; n <= max_sine_side; ++n) {
            const std::int32_t* b = sine_basis(n);
            const auto at = [&](int k, int x) { return k < n && x < n ? b[k * n + x] : 0; };
            for (int p = 0; p < max_sine_side / 2; ++p)
                for (int x = 0; x < max_sine_side; ++x)
                    of[n].next[p][x] = packed(at(2 * p, x), at(2 * p + 1, x));
        }
    }
};

const SinePairs& sine_pairs(int n) {
    static const AllSinePairs pairs;
    return pairs.of[n];
}

} // namespace
} // namespace tessera
