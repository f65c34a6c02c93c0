#include "codec/journal/journal_tiles.h"

#include "format/byte_source.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "format/io/system_calls.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace tessera {

namespace {

constexpr char file_magic[] = {'T', 'E', 'S', 'S', 'J', 'T', 'L', '2'}; // 2: sums of levels
constexpr char record_magic[] = {'T', 'I', 'L', 'E'};
constexpr std::size_t record_header = 44;
constexpr std::size_t summed_header = 40;
// A tile has at most 393,216 texels of four channels; no coding makes them five times larger.
constexpr std::uint32_t max_payload = 16u << 20;
constexpr std::uint32_t max_pass_bytes = 1u << 20;

using RecordHeader = std::array<std::byte, record_header>;

RecordHeader store_record(std::uint64_t tile, const CodedTile& figures,
                          std::span<const std::byte> payload) {
    RecordHeader header;
    std::memcpy(header.data(), record_magic, 4);
    store_le(header.data() + 4, static_cast<std::uint32_t>(payload.size()));
    store_le(header.data() + 8, tile);
    store_le(header.data() + 16, figures.squared_error);
    store_le(header.data() + 24, figures.levels_sum);
    store_le(header.data() + 28, figures.max_error);
    store_le(header.data() + 32, figures.nan_count);
    store_le(header.data() + 36, figures.infinity_count);
    const auto summed = std::span(header).first<summed_header>();
    store_le(header.data() + summed_header, crc32c(payload, crc32c(summed)));
    return header;
}

struct Record {
    std::uint64_t tile = 0;
    CodedTile figures;
};

// False where the bytes are no header.
bool load_record(std::span<const std::byte, record_header> header, Record& record) {
    const std::byte* h = header.data();
    record.figures.payload_bytes = load_le<std::uint32_t>(h + 4);
    record.tile = load_le<std::uint64_t>(h + 8);
    record.figures.squared_error = load_le<std::uint64_t>(h + 16);
    record.figures.levels_sum = load_le<std::uint32_t>(h + 24);
    record.figures.max_error = load_le<std::uint32_t>(h + 28);
    record.figures.nan_count = load_le<std::uint32_t>(h + 32);
    record.figures.infinity_count = load_le<std::uint32_t>(h + 36);
    return std::memcmp(h, record_magic, 4) == 0 && record.figures.payload_bytes <= max_payload;
}

// `bytes`: header and payload.
bool is_whole(std::span<const std::byte> bytes) {
    return crc32c(bytes.subspan(record_header), crc32c(bytes.first(summed_header))) ==
           load_le<std::uint32_t>(bytes.data() + summed_header);
}

// Reads up to out.size() bytes; what is missing is past the end of the file or cannot be read.
std::size_t read_some(int descriptor, std::uint64_t offset, std::span<std::byte> out) {
    std::size_t done = 0;
    while (done < out.size()) {
        const ssize_t got = ::pread(descriptor, out.data() + done, out.size() - done,
                                    static_cast<off_t>(offset + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            break;
        done += static_cast<std::size_t>(got);
    }
    return done;
}

// The start of a file in large reads: records are short.
class Window {
public:
    explicit Window(int descriptor) : descriptor_(descriptor) {}
    // The `length` bytes at `offset`, or fewer at the file's end. Valid until the next call.
    std::span<const std::byte> at(std::uint64_t offset, std::size_t length) {
        if (offset < begin_ || offset + length > begin_ + bytes_.size()) {
            bytes_.resize(std::max(length, chunk));
            bytes_.resize(read_some(descriptor_, offset, bytes_));
            begin_ = offset;
        }
        const std::size_t skip = offset - begin_;
        return std::span<const std::byte>(bytes_).subspan(skip,
                                                          std::min(length, bytes_.size() - skip));
    }

private:
    static constexpr std::size_t chunk = 1u << 20;
    int descriptor_;
    std::uint64_t begin_ = 0;
    std::vector<std::byte> bytes_;
};

std::vector<std::byte> file_header(std::span<const std::byte> pass) {
    std::vector<std::byte> header;
    append_bytes(header, std::as_bytes(std::span(file_magic)));
    append_le(header, static_cast<std::uint32_t>(pass.size()));
    append_bytes(header, pass);
    append_le(header, crc32c(header));
    return header;
}

// O_NOFOLLOW: the name is ours, and a link there is somebody's trap.
constexpr int open_flags = O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW;

} // namespace

JournalTiles::~JournalTiles() {
    ::close(descriptor_);
}

Status JournalTiles::begin(std::span<const std::byte> pass) {
    if (pass.size() > max_pass_bytes)
        return {ErrorCode::bad_argument, path_ + ": a pass needs more than 1 MiB to describe"};
    if (sys::ftruncate(descriptor_, 0) < 0)
        return sys::system_error(path_, "cannot empty", errno);
    const std::vector<std::byte> header = file_header(pass);
    TESSERA_TRY(sys::write_all(descriptor_, path_, header, 0));
    end_ = header.size();
    return {};
}

Result<std::unique_ptr<JournalTiles>> JournalTiles::create(const std::string& path,
                                                           std::uint64_t tiles,
                                                           std::span<const std::byte> pass) {
    const int descriptor = sys::open(path.c_str(), open_flags, 0666);
    if (descriptor < 0)
        return sys::system_error(path, "cannot create", errno);
    std::unique_ptr<JournalTiles> store(new JournalTiles(descriptor, path, tiles));
    TESSERA_TRY(store->begin(pass));
    return store;
}

Result<std::unique_ptr<JournalTiles>> JournalTiles::create_nameless(const std::string& path,
                                                                    std::uint64_t tiles) {
    auto store = create(path, tiles, {});
    ::unlink(path.c_str());
    return store;
}

Result<std::unique_ptr<JournalTiles>> JournalTiles::resume(const std::string& path,
                                                           std::span<const std::byte> pass,
                                                           std::vector<CodedTile>& figures) {
    const int descriptor = sys::open(path.c_str(), open_flags, 0666);
    if (descriptor < 0)
        return sys::system_error(path, "cannot open", errno);
    std::unique_ptr<JournalTiles> store(new JournalTiles(descriptor, path, figures.size()));
    if (!store->scan(pass, figures))
        TESSERA_TRY(store->begin(pass));
    else if (sys::ftruncate(descriptor, static_cast<off_t>(store->end_)) < 0)
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

bool JournalTiles::scan(std::span<const std::byte> pass, std::vector<CodedTile>& figures) {
    Window window(descriptor_);
    const std::vector<std::byte> header = file_header(pass);
    if (!std::ranges::equal(window.at(0, header.size()), header))
        return false;
    end_ = header.size();
    for (;;) {
        std::span<const std::byte> bytes = window.at(end_, record_header);
        Record record;
        if (bytes.size() < record_header || !load_record(bytes.first<record_header>(), record) ||
            record.tile >= places_.size())
            return true;
        const std::size_t length = record_header + record.figures.payload_bytes;
        bytes = window.at(end_, length);
        if (bytes.size() < length || !is_whole(bytes))
            return true;
        places_[record.tile] = {end_, record.figures.payload_bytes};
        figures[record.tile] = record.figures;
        end_ += length;
    }
}

Status JournalTiles::put(std::uint64_t tile, const CodedTile& figures,
                         std::span<const std::byte> payload) {
    if (payload.size() > max_payload)
        return {ErrorCode::unsupported, path_ + ": a tile of " + std::to_string(payload.size()) +
                                            " bytes is too large for a journal"};
    const RecordHeader header = store_record(tile, figures, payload);
    std::vector<std::byte> record(header.begin(), header.end());
    append_bytes(record, payload);
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
        return {ErrorCode::bad_argument, path_ + ": " + name + " is not in it"};
    out.resize(record_header + place.bytes);
    if (read_some(descriptor_, place.offset, out) != out.size())
        return {ErrorCode::io, path_ + ": cannot read " + name};
    if (!is_whole(out))
        return {ErrorCode::io, path_ + ": " + name + " was changed on the disk"};
    out.erase(out.begin(), out.begin() + record_header);
    return {};
}

} // namespace tessera
