#include "codec/journal/journal_tiles.h"

#include "format/byte_source.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "format/io/system_calls.h"

#include <algorithm>
#include <array>
#include <cerrno>

namespace tessera {
namespace {

constexpr char file_magic[] = {'T', 'E', 'S', 'S', 'J', 'T', 'L', '2'};
constexpr char record_magic[] = {'T', 'I', 'L', 'E'};
constexpr std::size_t summed_header = 40;                // bytes that the CRC covers
constexpr std::size_t record_header = summed_header + 4; // with the CRC
// A tile has at most 393,216 texels of four channels, and no coding makes them five times larger.
constexpr std::uint32_t max_payload = 16u << 20;
constexpr std::uint32_t max_pass_bytes = 1u << 20;

std::vector<std::byte> record_of(std::uint64_t tile, const CodedTile& figures,
                                 std::span<const std::byte> payload) {
    std::vector<std::byte> record;
    record.reserve(record_header + payload.size());
    append_bytes(record, std::as_bytes(std::span(record_magic)));
    append_le(record, static_cast<std::uint32_t>(payload.size()));
    append_le(record, tile);
    append_le(record, figures.squared_error);
    append_le(record, figures.levels_sum);
    append_le(record, figures.max_error);
    append_le(record, figures.nan_count);
    append_le(record, figures.infinity_count);
    append_le(record, crc32c(payload, crc32c(record)));
    append_bytes(record, payload);
    return record;
}

// Reads a record's header. False if the bytes are none.
bool load_header(std::span<const std::byte> header, std::uint64_t& tile, CodedTile& figures) {
    ByteReader in(header);
    std::span<const std::byte> magic;
    return in.take(sizeof record_magic, magic) &&
           std::ranges::equal(magic, std::as_bytes(std::span(record_magic))) &&
           in.take(figures.payload_bytes) && in.take(tile) && in.take(figures.squared_error) &&
           in.take(figures.levels_sum) && in.take(figures.max_error) &&
           in.take(figures.nan_count) && in.take(figures.infinity_count) && in.remaining() >= 4 &&
           figures.payload_bytes <= max_payload;
}

bool is_whole(std::span<const std::byte> record) {
    return crc32c(record.subspan(record_header), crc32c(record.first(summed_header))) ==
           load_le<std::uint32_t>(record.data() + summed_header);
}

// Reads up to out.size() bytes, fewer at the end of the file and where it cannot be read.
std::size_t read_some(int descriptor, std::uint64_t offset, std::span<std::byte> out) {
    std::size_t done = 0;
    while (done < out.size()) {
        const std::int64_t got = sys::read_at(descriptor, out.subspan(done), offset + done);
        if (got <= 0)
            break;
        done += static_cast<std::size_t>(got);
    }
    return done;
}

std::vector<std::byte> file_header(std::span<const std::byte> pass) {
    std::vector<std::byte> header;
    append_bytes(header, std::as_bytes(std::span(file_magic)));
    append_le(header, static_cast<std::uint32_t>(pass.size()));
    append_bytes(header, pass);
    append_le(header, crc32c(header));
    return header;
}

} // namespace

JournalTiles::~JournalTiles() {
    sys::drop(descriptor_);
}

Result<std::unique_ptr<JournalTiles>> JournalTiles::open(const std::string& path,
                                                         std::uint64_t tiles) {
    // The encoder makes no links, so a link of that name is an attack, which this refuses.
    const int descriptor = sys::open(path, sys::Access::update);
    if (descriptor < 0)
        return sys::system_error(path, "cannot open", errno);
    return std::unique_ptr<JournalTiles>(new JournalTiles(descriptor, path, tiles));
}

Status JournalTiles::begin(std::span<const std::byte> pass) {
    if (pass.size() > max_pass_bytes)
        return {ErrorCode::bad_argument, path_ + ": a pass needs more than 1 MiB to describe"};
    if (sys::truncate(descriptor_, 0) < 0)
        return sys::system_error(path_, "cannot empty", errno);
    const std::vector<std::byte> header = file_header(pass);
    TESSERA_TRY(sys::write_all(descriptor_, path_, header, 0));
    end_ = header.size();
    return {};
}

Result<std::unique_ptr<JournalTiles>> JournalTiles::create_nameless(const std::string& path,
                                                                    std::uint64_t tiles) {
    TESSERA_TRY_ASSIGN(auto store, open(path, tiles));
    const Status status = store->begin({});
    sys::remove_file(path);
    TESSERA_TRY(status);
    return store;
}

Result<std::unique_ptr<JournalTiles>> JournalTiles::resume(const std::string& path,
                                                           std::span<const std::byte> pass,
                                                           std::vector<CodedTile>& figures) {
    TESSERA_TRY_ASSIGN(auto store, open(path, figures.size()));
    if (!store->scan(pass, figures))
        TESSERA_TRY(store->begin(pass));
    else if (sys::truncate(store->descriptor_, store->end_) < 0)
        return sys::system_error(path, "cannot cut off its torn end", errno);
    return store;
}

bool JournalTiles::holds_any(const std::string& path) {
    const auto file = open_file(path);
    std::array<std::byte, sizeof file_magic + 4> start;
    if (!file || !(*file)->read(0, start))
        return false;
    const std::uint64_t header =
        start.size() + load_le<std::uint32_t>(start.data() + sizeof file_magic) + 4;
    return (*file)->size() > header + record_header;
}

// Finds the whole records. False if the file is not of this pass.
bool JournalTiles::scan(std::span<const std::byte> pass, std::vector<CodedTile>& figures) {
    const std::vector<std::byte> header = file_header(pass);
    std::vector<std::byte> record(header.size());
    if (read_some(descriptor_, 0, record) < record.size() || record != header)
        return false;
    end_ = header.size();
    for (;;) {
        std::uint64_t tile = 0;
        CodedTile coded;
        record.resize(record_header);
        if (read_some(descriptor_, end_, record) < record.size() ||
            !load_header(record, tile, coded) || tile >= places_.size())
            return true;
        record.resize(record_header + coded.payload_bytes);
        if (read_some(descriptor_, end_, record) < record.size() || !is_whole(record))
            return true;
        places_[tile] = {end_, coded.payload_bytes};
        figures[tile] = coded;
        end_ += record.size();
    }
}

Status JournalTiles::put(std::uint64_t tile, const CodedTile& figures,
                         std::span<const std::byte> payload) {
    if (payload.size() > max_payload)
        return {ErrorCode::unsupported, path_ + ": a tile of " + std::to_string(payload.size()) +
                                            " bytes is too large for a journal"};
    const std::vector<std::byte> record = record_of(tile, figures, payload);
    const std::lock_guard lock(mutex_);
    TESSERA_TRY(sys::write_all(descriptor_, path_, record, end_));
    places_[tile] = {end_, static_cast<std::uint32_t>(payload.size())};
    end_ += record.size();
    return {};
}

Status JournalTiles::get(std::uint64_t tile, std::vector<std::byte>& out) const {
    const Place place = places_[tile];
    const std::string name = "tile " + std::to_string(tile);
    if (place.offset == 0)
        return {ErrorCode::bad_argument, path_ + ": has no " + name};
    out.resize(record_header + place.bytes);
    if (read_some(descriptor_, place.offset, out) != out.size())
        return {ErrorCode::io, path_ + ": cannot read " + name};
    if (!is_whole(out))
        return {ErrorCode::io, path_ + ": " + name + " was changed on disk"};
    out.erase(out.begin(), out.begin() + record_header);
    return {};
}

} // namespace tessera
