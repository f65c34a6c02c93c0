#include "codec/journal/journal.h"

#include "codec/encoder.h" // journal_path
#include "format/byte_source.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "format/io/system_calls.h"
#include "format/io/unfinished.h"
#include "format/output_file.h"
#include "format/tile/limits.h"

#include <algorithm>
#include <bit>
#include <cerrno>

namespace tessera {
namespace {

constexpr char head_magic[] = {'T', 'E', 'S', 'S', 'J', 'H', 'D', '1'};
constexpr char done_magic[] = {'T', 'E', 'S', 'S', 'J', 'D', 'N', '1'};
constexpr std::uint64_t max_file_bytes = 1u << 22; // of head and done
constexpr std::uint32_t max_facts = 10000;

bool is_number(const std::string& text) {
    return !text.empty() && text.size() <= 9 &&
           std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

// Whether the encoder makes files of this name in a journal's folder; only these are removed.
bool is_ours(const std::string& name) {
    for (const std::string kind : {"pass-", "done-", "fitted-"})
        if (name.starts_with(kind) && is_number(name.substr(kind.size())))
            return true;
    for (const char* known : {"lock", "head", "output", "writing"})
        if (name == known)
            return true;
    return false;
}

// The content of a small file that ends with its CRC32C; empty if there is no whole one.
std::vector<std::byte> read_sealed(const std::string& path) {
    const auto source = open_file(path);
    if (!source || (*source)->size() < 4 || (*source)->size() > max_file_bytes)
        return {};
    std::vector<std::byte> bytes((*source)->size());
    if (!(*source)->read(0, bytes))
        return {};
    const auto summed = std::span<const std::byte>(bytes).first(bytes.size() - 4);
    if (crc32c(summed) != load_le<std::uint32_t>(bytes.data() + summed.size()))
        return {};
    bytes.resize(summed.size());
    return bytes;
}

// Writes such a file under a temporary name, so that it appears whole or not at all.
Status write_sealed(const std::string& path, const std::string& temporary,
                    std::vector<std::byte> bytes) {
    append_le(bytes, crc32c(bytes));
    TESSERA_TRY_ASSIGN(OutputFile file, OutputFile::create(path, temporary));
    TESSERA_TRY(file.append(bytes));
    return file.commit();
}

void append_text(std::vector<std::byte>& out, const std::string& text) {
    append_le(out, static_cast<std::uint32_t>(text.size()));
    append_bytes(out, std::as_bytes(std::span(text)));
}

bool take_text(ByteReader& in, std::string& text) {
    std::uint32_t length = 0;
    std::span<const std::byte> bytes;
    if (!in.take(length) || !in.take(length, bytes))
        return false;
    text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return true;
}

std::vector<std::byte> store_facts(const JournalFacts& facts) {
    std::vector<std::byte> out;
    append_bytes(out, std::as_bytes(std::span(head_magic)));
    append_le(out, static_cast<std::uint32_t>(facts.size()));
    for (const auto& [name, value] : facts) {
        append_text(out, name);
        append_text(out, value);
    }
    return out;
}

std::optional<JournalFacts> load_facts(std::span<const std::byte> bytes) {
    ByteReader in(bytes);
    std::span<const std::byte> magic;
    std::uint32_t count = 0;
    if (!in.take(sizeof head_magic, magic) ||
        !std::ranges::equal(magic, std::as_bytes(std::span(head_magic))) || !in.take(count) ||
        count > max_facts)
        return std::nullopt;
    JournalFacts facts(count);
    for (auto& [name, value] : facts)
        if (!take_text(in, name) || !take_text(in, value))
            return std::nullopt;
    return facts;
}

std::string value_in(const JournalFacts& facts, const std::string& name) {
    for (const auto& [known, value] : facts)
        if (known == name)
            return value;
    return {};
}

// Which of the facts that `named` lists differs first, in words; empty if none does.
std::string difference(const JournalFacts& named, const JournalFacts& before,
                       const JournalFacts& now) {
    const auto quoted = [](const std::string& value) {
        return value.empty() ? std::string("not given") : "'" + value.substr(0, 200) + "'";
    };
    for (const auto& [name, value] : named)
        if (const std::string was = value_in(before, name), is = value_in(now, name); was != is)
            return name + " was " + quoted(was) + " and is " + quoted(is);
    return {};
}

// Identifies a pass.
std::vector<std::byte> pass_name(unsigned number, const CodingParameters& parameters) {
    std::vector<std::byte> name;
    append_le(name, static_cast<std::uint32_t>(number));
    append_bytes(name, write_coding_parameters(parameters, max_planes, true));
    return name;
}

std::vector<std::byte> store_totals(const PassTotals& totals) {
    std::vector<std::byte> out;
    append_le(out, std::bit_cast<std::uint64_t>(totals.squared_error));
    append_le(out, totals.max_error);
    append_le(out, totals.nan_count);
    append_le(out, totals.infinity_count);
    append_le(out, totals.file_bytes);
    for (const auto* counts : {&totals.statistics.stops, &totals.statistics.goes})
        for (const std::uint64_t count : *counts)
            append_le(out, count);
    return out;
}

std::optional<PassTotals> load_totals(std::span<const std::byte> bytes) {
    ByteReader in(bytes);
    PassTotals totals;
    std::uint64_t squared_error = 0;
    if (!in.take(squared_error) || !in.take(totals.max_error) || !in.take(totals.nan_count) ||
        !in.take(totals.infinity_count) || !in.take(totals.file_bytes))
        return std::nullopt;
    totals.squared_error = std::bit_cast<double>(squared_error);
    for (auto* counts : {&totals.statistics.stops, &totals.statistics.goes})
        for (std::uint64_t& count : *counts)
            if (!in.take(count))
                return std::nullopt;
    return in.remaining() == 0 && totals.squared_error >= 0 ? std::optional(totals) : std::nullopt;
}

// Everything in a done-N before its totals.
std::vector<std::byte> done_head(unsigned number, const CodingParameters& parameters) {
    std::vector<std::byte> head;
    append_bytes(head, std::as_bytes(std::span(done_magic)));
    const std::vector<std::byte> name = pass_name(number, parameters);
    append_le(head, static_cast<std::uint32_t>(name.size()));
    append_bytes(head, name);
    return head;
}

enum class LockState { missing, free, held };

// The state of the lock of an output's journal.
LockState lock_of(const std::string& output) {
    const int lock = sys::open(journal_path(output) + "/lock", sys::Access::read_no_link);
    if (lock < 0)
        return LockState::missing;
    const bool is_free = sys::lock(lock) == sys::Lock::taken;
    sys::drop(lock);
    return is_free ? LockState::free : LockState::held;
}

} // namespace

std::string journal_path(const std::string& output) {
    return output + ".journal";
}

bool is_being_encoded(const std::string& output) {
    return lock_of(output) == LockState::held;
}

bool holds_finished_tiles(const std::string& output) {
    return lock_of(output) == LockState::free && Journal::holds_tiles(journal_path(output));
}

Result<std::unique_ptr<Journal>> Journal::open(const std::string& output) {
    std::unique_ptr<Journal> journal(new Journal(journal_path(output)));
    TESSERA_TRY(journal->lock());
    note_unfinished(journal->folder_, [held = journal.get()] {
        if (holds_tiles(held->folder_))
            return true;
        held->remove();
        return false;
    });
    return journal;
}

Status Journal::lock() {
    // The process that holds the lock removes the folder at its end, perhaps before we have locked
    // the file in it.
    constexpr int attempts = 100;
    for (int attempt = 0; attempt < attempts; ++attempt) {
        if (sys::make_folder(folder_) < 0 && errno != EEXIST)
            return sys::system_error(folder_, "cannot create", errno);
        if (sys::is_other_than_folder(folder_))
            return {ErrorCode::io,
                    folder_ + ": the journal needs this name, but it is not a folder"};
        const std::string path = file("lock");
        lock_ = sys::open(path, sys::Access::update);
        if (lock_ < 0 && errno == ENOENT)
            continue;
        if (lock_ < 0) {
            const Status status = sys::system_error(path, "cannot create", errno);
            sys::remove_empty_folder(folder_); // fails unless the folder is empty, as we made it
            return status;
        }
        if (const sys::Lock state = sys::lock(lock_); state != sys::Lock::taken) {
            const int error = errno;
            sys::drop(std::exchange(lock_, -1));
            if (state == sys::Lock::failed)
                return sys::system_error(path, "cannot lock", error);
            return {ErrorCode::io, folder_ + ": another process is writing this output now"};
        }
        sys::FileFacts held, named;
        if (sys::facts_of(lock_, held) == 0 && sys::facts_of(path, named) == 0 &&
            held.number == named.number && held.device == named.device)
            return {};
        sys::drop(std::exchange(lock_, -1));
    }
    return {ErrorCode::io, folder_ + ": cannot be locked: other processes keep replacing it"};
}

Journal::~Journal() {
    if (lock_ < 0 && !removed_)
        return; // it was never locked
    forget_unfinished(folder_);
    if (!removed_ && !holds_tiles(folder_))
        remove();
    if (lock_ >= 0)
        sys::drop(lock_);
}

std::vector<std::string> Journal::our_files(const std::string& folder) {
    std::vector<std::string> names;
    sys::list_folder(folder, names);
    std::erase_if(names, [](const std::string& name) { return !is_ours(name); });
    return names;
}

// Removes all files but the lock.
void Journal::empty() {
    for (const std::string& name : our_files(folder_))
        if (name != "lock")
            sys::remove_file(file(name));
}

void Journal::remove() {
    if (std::exchange(removed_, true))
        return;
    empty();
    sys::remove_file(file("lock"));
    sys::drop(std::exchange(lock_, -1)); // Windows removes the file's name only now
    sys::remove_empty_folder(folder_);   // fails if there are other files in it
}

Status Journal::refuse_resume(const std::string& difference) const {
    return {ErrorCode::bad_argument, folder_ + ": cannot resume: " + difference +
                                         " (without resuming, the encoder starts again)"};
}

Status Journal::may_resume(const JournalFacts& known) const {
    const std::optional<JournalFacts> before = load_facts(read_sealed(file("head")));
    const std::string changed = before ? difference(known, *before, known) : "";
    return changed.empty() ? Status() : refuse_resume(changed);
}

Status Journal::begin(const JournalFacts& facts, bool resume) {
    // Without a whole head, nothing says what the tiles are.
    const std::optional<JournalFacts> before =
        resume ? load_facts(read_sealed(file("head"))) : std::nullopt;
    if (before) {
        for (const JournalFacts* named : {&facts, &*before})
            if (const std::string changed = difference(*named, *before, facts); !changed.empty())
                return refuse_resume(changed);
        if (*before != facts)
            return refuse_resume("its facts are in another order");
        begun_ = true;
        return {};
    }
    empty();
    begun_ = true;
    return write_sealed(file("head"), file("writing"), store_facts(facts));
}

Result<std::unique_ptr<JournalTiles>> Journal::pass(unsigned number,
                                                    const CodingParameters& parameters,
                                                    std::vector<CodedTile>& figures) {
    return JournalTiles::resume(file("pass-", number), pass_name(number, parameters), figures);
}

Result<std::unique_ptr<JournalTiles>> Journal::scratch(std::uint64_t tiles) {
    return JournalTiles::create_nameless(file("fitted-", ++scratches_), tiles);
}

std::optional<PassTotals> Journal::finished(unsigned number,
                                            const CodingParameters& parameters) const {
    const std::vector<std::byte> bytes = read_sealed(file("done-", number));
    const std::vector<std::byte> head = done_head(number, parameters);
    if (bytes.size() < head.size() || !std::equal(head.begin(), head.end(), bytes.begin()))
        return std::nullopt;
    return load_totals(std::span(bytes).subspan(head.size()));
}

Status Journal::finish(unsigned number, const CodingParameters& parameters,
                       const PassTotals& totals) {
    std::vector<std::byte> bytes = done_head(number, parameters);
    append_bytes(bytes, store_totals(totals));
    return write_sealed(file("done-", number), file("writing"), std::move(bytes));
}

void Journal::drop(unsigned number) {
    sys::remove_file(file("pass-", number));
}

bool Journal::holds_tiles(const std::string& folder) {
    for (const std::string& name : our_files(folder))
        if (name.rfind("done-", 0) == 0 ||
            (name.rfind("pass-", 0) == 0 && JournalTiles::holds_any(folder + "/" + name)))
            return true;
    return false;
}

} // namespace tessera
