#include "format/surface/chart_tables.h"

#include "format/io/bytes.h"
#include "format/surface/mesh_check.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <draco/compression/entropy/symbol_decoding.h>
#include <draco/compression/entropy/symbol_encoding.h>
#include <limits>
#include <string>
#include <string_view>
#include <unordered_map>

namespace tessera {
namespace {

constexpr std::string_view charts_name = "CHRT";
constexpr std::size_t header_bytes = 44;
constexpr std::uint32_t most_side = 1u << 24; // of the atlas
constexpr int rotation_offset = 128;          // the tables hold numbers from 0
constexpr std::size_t context_count = ChartedStream::context_count;
// How a triangle names its chart. Smaller symbols name that of an earlier neighbour.
constexpr std::uint32_t new_chart = 3, other_chart = 4;

Status invalid_charts(const std::string& text) {
    return {ErrorCode::invalid_file, "the mesh's charts " + text};
}

// The charts that a triangle probably belongs to, most probable first.
struct ChartGuess {
    std::array<std::uint32_t, 3> charts{};
    std::size_t count = 0;
    std::size_t context = 0; // the kind of neighbourhood, which tells how probable they are
};

// Follows the triangles in their order and guesses the chart of each from its earlier neighbours.
class ChartGuesser {
public:
    explicit ChartGuesser(const SurfaceMesh& mesh)
        : mesh_(mesh), positions_(number_positions(mesh)) {
        edges_.reserve(3 * mesh.triangles.size());
    }

    // `chart_of` has the charts of all triangles before.
    ChartGuess guess(std::uint32_t triangle, std::span<const std::uint32_t> chart_of) const {
        std::array<std::uint32_t, 3> neighbours{}; // the latest first
        std::size_t found = 0;
        for (std::size_t k = 0; k < 3; ++k)
            if (const auto it = edges_.find(edge(triangle, (k + 1) % 3, k)); it != edges_.end()) {
                std::size_t place = found++;
                for (; place > 0 && neighbours[place - 1] < it->second; --place)
                    neighbours[place] = neighbours[place - 1];
                neighbours[place] = it->second;
            }
        ChartGuess out;
        for (std::size_t i = 0; i < found; ++i) {
            const std::uint32_t chart = chart_of[neighbours[i]];
            const auto end = out.charts.begin() + out.count;
            if (std::find(out.charts.begin(), end, chart) == end)
                out.charts[out.count++] = chart;
        }
        out.context = found < 2 ? found : out.count == 1 ? 2 : 3;
        return out;
    }

    void pass(std::uint32_t triangle) {
        for (std::size_t k = 0; k < 3; ++k)
            edges_[edge(triangle, k, (k + 1) % 3)] = triangle;
    }

private:
    std::uint64_t edge(std::uint32_t triangle, std::size_t from, std::size_t to) const {
        const auto& corners = mesh_.triangles[triangle];
        return std::uint64_t{positions_[corners[from]]} << 32 | positions_[corners[to]];
    }

    const SurfaceMesh& mesh_;
    std::vector<std::uint32_t> positions_;
    std::unordered_map<std::uint64_t, std::uint32_t> edges_; // the last triangle with each
};

using Numbers = std::vector<std::uint32_t>;

// What the tables hold.
struct ChartNumbers {
    std::array<Numbers, context_count> symbols;
    Numbers distances;             // to the charts of other_chart
    std::array<Numbers, 7> fields; // of each chart: rotation, scale, begin
};

bool put_numbers(const Numbers& numbers, draco::EncoderBuffer& to) {
    return draco::EncodeSymbols(numbers.data(), static_cast<int>(numbers.size()), 1, nullptr, &to);
}

class TableReader {
public:
    explicit TableReader(std::span<const std::byte> bytes) {
        buffer_.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size(),
                     DRACO_BITSTREAM_VERSION(2, 2));
    }
    bool take(std::size_t count, Numbers& numbers) {
        numbers.resize(count);
        return draco::DecodeSymbols(static_cast<std::uint32_t>(count), 1, &buffer_, numbers.data());
    }
    bool is_at_end() const { return buffer_.remaining_size() == 0; }

private:
    draco::DecoderBuffer buffer_;
};

Result<ChartNumbers> read_tables(const ChartedStream& stream, std::size_t triangles) {
    ChartNumbers tables;
    TableReader reader(stream.tables);
    if (std::ranges::any_of(stream.counts, [&](auto count) { return count > triangles; }))
        return invalid_charts("claim too many symbols");
    bool ok = true;
    for (std::size_t i = 0; i < context_count; ++i)
        ok = ok && reader.take(stream.counts[i], tables.symbols[i]);
    ok = ok && reader.take(stream.counts[context_count], tables.distances);
    for (Numbers& field : tables.fields)
        ok = ok && reader.take(stream.charts, field);
    if (!ok || !reader.is_at_end())
        return invalid_charts("are damaged");
    return tables;
}

Result<std::vector<std::uint32_t>>
charts_of_triangles(const ChartNumbers& tables, const SurfaceMesh& mesh, std::uint32_t charts) {
    ChartGuesser guesser(mesh);
    std::vector<std::uint32_t> chart_of;
    std::array<std::size_t, context_count> next{};
    std::size_t next_distance = 0;
    std::uint32_t seen = 0;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const ChartGuess guess = guesser.guess(i, chart_of);
        const Numbers& symbols = tables.symbols[guess.context];
        if (next[guess.context] == symbols.size())
            return invalid_charts("end before the triangles");
        const std::uint32_t symbol = symbols[next[guess.context]++];
        if (symbol < guess.count) {
            chart_of.push_back(guess.charts[symbol]);
        } else if (symbol == new_chart && seen < charts) {
            chart_of.push_back(seen++);
        } else if (symbol == other_chart && next_distance < tables.distances.size() &&
                   tables.distances[next_distance] < seen) {
            chart_of.push_back(seen - 1 - tables.distances[next_distance++]);
        } else {
            return invalid_charts("do not exist at triangle " + std::to_string(i));
        }
        guesser.pass(i);
    }
    const bool all_used = seen == charts && next_distance == tables.distances.size();
    for (std::size_t i = 0; i < context_count; ++i)
        if (!all_used || next[i] != tables.symbols[i].size())
            return invalid_charts("do not match the triangles");
    return chart_of;
}

Result<MeshChart> chart_of_fields(const ChartNumbers& tables, std::size_t chart) {
    MeshChart out;
    bool is_rotation = false;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::uint32_t value = tables.fields[i][chart];
        if (value == 0 || value > 255)
            return invalid_charts("have a wrong rotation");
        out.rotation[i] = static_cast<std::int8_t>(static_cast<int>(value) - rotation_offset);
        is_rotation |= out.rotation[i] != 0;
    }
    if (!is_rotation || tables.fields[4][chart] > 255)
        return invalid_charts("have a wrong rotation or scale");
    out.scale = static_cast<std::uint8_t>(tables.fields[4][chart]);
    out.begin = {tables.fields[5][chart], tables.fields[6][chart]};
    return out;
}

Status check_charts(const MeshCharts& charts, std::size_t triangles) {
    const auto wrong = [](const std::string& text) {
        return Status(ErrorCode::bad_argument, "the mesh's charts " + text);
    };
    if (charts.chart_of.size() != triangles)
        return wrong("are for " + std::to_string(charts.chart_of.size()) + " triangles, not " +
                     std::to_string(triangles));
    if (!(charts.density > 0.0f) || !std::isfinite(charts.density))
        return wrong("must have a density above 0");
    for (const std::uint32_t side : charts.size)
        if (side == 0 || side > most_side)
            return wrong("need an atlas of 1 to 2^24 texels along a side");
    for (const MeshChart& chart : charts.charts)
        if (std::ranges::all_of(chart.rotation, [](int x) { return x == 0; }) ||
            std::ranges::count(chart.rotation, std::int8_t{-128}) > 0)
            return wrong("must have rotations of -127 to 127 that are not 0");
    for (const std::uint32_t chart : charts.chart_of)
        if (chart >= charts.charts.size())
            return wrong("do not include chart " + std::to_string(chart));
    return {};
}

ChartNumbers make_tables(const SurfaceMesh& mesh, const MeshCharts& charts,
                         std::vector<std::uint32_t>& order) {
    ChartNumbers tables;
    ChartGuesser guesser(mesh);
    constexpr std::uint32_t unseen = UINT32_MAX;
    std::vector<std::uint32_t> numbers(charts.charts.size(), unseen), coded;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        std::uint32_t& number = numbers[charts.chart_of[i]];
        const ChartGuess guess = guesser.guess(i, coded);
        const auto end = guess.charts.begin() + guess.count;
        const auto found = std::find(guess.charts.begin(), end, number);
        std::uint32_t symbol = new_chart;
        if (number == unseen) {
            number = static_cast<std::uint32_t>(order.size());
            order.push_back(charts.chart_of[i]);
        } else if (found != end) {
            symbol = static_cast<std::uint32_t>(found - guess.charts.begin());
        } else {
            symbol = other_chart;
            tables.distances.push_back(static_cast<std::uint32_t>(order.size()) - 1 - number);
        }
        tables.symbols[guess.context].push_back(symbol);
        coded.push_back(number);
        guesser.pass(i);
    }
    for (const std::uint32_t chart : order) {
        const MeshChart& c = charts.charts[chart];
        for (std::size_t k = 0; k < 4; ++k)
            tables.fields[k].push_back(static_cast<std::uint32_t>(c.rotation[k] + rotation_offset));
        tables.fields[4].push_back(c.scale);
        tables.fields[5].push_back(c.begin[0]);
        tables.fields[6].push_back(c.begin[1]);
    }
    return tables;
}

} // namespace

bool has_chart_tables(std::span<const std::byte> section) {
    const auto name = std::as_bytes(std::span(charts_name));
    return section.size() >= name.size() && std::ranges::equal(section.first(name.size()), name);
}

Result<ChartedStream> split_charted(std::span<const std::byte> section) {
    if (section.size() < header_bytes)
        return invalid_charts("are cut off");
    const auto u32 = [&](std::size_t at) { return load_le<std::uint32_t>(section.data() + at); };
    ChartedStream out;
    const std::uint32_t shape_bytes = u32(4);
    out.charts = u32(8);
    out.size = {u32(12), u32(16)};
    out.density = std::bit_cast<float>(u32(20));
    for (std::size_t i = 0; i < out.counts.size(); ++i)
        out.counts[i] = u32(24 + 4 * i);
    if (shape_bytes > section.size() - header_bytes)
        return invalid_charts("are cut off");
    for (const std::uint32_t side : out.size)
        if (side == 0 || side > most_side)
            return invalid_charts("have an atlas of " + std::to_string(side) +
                                  " texels along a side");
    if (!(out.density > 0.0f) || !std::isfinite(out.density))
        return invalid_charts("have no density");
    out.shape = section.subspan(header_bytes, shape_bytes);
    out.tables = section.subspan(header_bytes + shape_bytes);
    return out;
}

Result<MeshCharts> read_chart_tables(const ChartedStream& stream, const SurfaceMesh& mesh) {
    if (stream.charts == 0 || stream.charts > mesh.triangles.size())
        return invalid_charts("number " + std::to_string(stream.charts) + " for " +
                              std::to_string(mesh.triangles.size()) + " triangles");
    TESSERA_TRY_ASSIGN(const ChartNumbers tables, read_tables(stream, mesh.triangles.size()));
    MeshCharts charts{.size = stream.size, .density = stream.density, .charts = {}, .chart_of = {}};
    TESSERA_TRY_ASSIGN(charts.chart_of, charts_of_triangles(tables, mesh, stream.charts));
    for (std::size_t i = 0; i < stream.charts; ++i) {
        TESSERA_TRY_ASSIGN(const MeshChart chart, chart_of_fields(tables, i));
        charts.charts.push_back(chart);
    }
    return charts;
}

Result<std::vector<std::byte>> add_charts(std::span<const std::byte> shape,
                                          const MeshCharts& charts) {
    TESSERA_TRY_ASSIGN(SurfaceMesh mesh,
                       decode_shape(shape, std::numeric_limits<std::uint64_t>::max()));
    TESSERA_TRY(check_charts(charts, mesh.triangles.size()));
    std::vector<std::uint32_t> order;
    const ChartNumbers tables = make_tables(mesh, charts, order);
    draco::EncoderBuffer buffer;
    bool ok = true;
    for (const Numbers& symbols : tables.symbols)
        ok = ok && put_numbers(symbols, buffer);
    ok = ok && put_numbers(tables.distances, buffer);
    for (const Numbers& field : tables.fields)
        ok = ok && put_numbers(field, buffer);
    if (!ok)
        return Status(ErrorCode::runtime, "Draco could not encode the charts");
    std::vector<std::byte> out(std::as_bytes(std::span(charts_name)).begin(),
                               std::as_bytes(std::span(charts_name)).end());
    append_le(out, static_cast<std::uint32_t>(shape.size()));
    append_le(out, static_cast<std::uint32_t>(order.size()));
    append_le(out, charts.size[0]);
    append_le(out, charts.size[1]);
    append_le(out, std::bit_cast<std::uint32_t>(charts.density));
    for (const Numbers& symbols : tables.symbols)
        append_le(out, static_cast<std::uint32_t>(symbols.size()));
    append_le(out, static_cast<std::uint32_t>(tables.distances.size()));
    out.insert(out.end(), shape.begin(), shape.end());
    const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
    out.insert(out.end(), bytes.begin(), bytes.end());
    if (const Status laid = lay_charts(mesh, charts); !laid)
        return Status(ErrorCode::bad_argument, laid.message());
    return out;
}

} // namespace tessera
