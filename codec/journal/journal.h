// What an encode keeps beside its output so that it can go on after a kill: a folder
// "<output>.journal" with
//   lock      held (flock) by the process that encodes
//   head      what is encoded and how: a resume under other facts is refused
//   pass-N    the tiles of pass N (journal_tiles.h), as long as they may be needed
//   done-N    what rate control wants to know of a finished pass, so that it need not be repeated
//   fitted    payloads under fitted tables; nameless, made again after a resume
//   output    the file in the making, until it is renamed
// Rate control is deterministic, so a resumed run asks for the same passes in the same order and
// finds the finished ones here. Files are little-endian, each with a CRC32C; one that is torn,
// damaged or of another pass counts as not there. Nothing in them is trusted. Not synced to the
// disk: a power failure may cost tiles, which the checksums show.
#pragma once

#include "codec/entropy/tile_entropy.h"
#include "codec/journal/journal_tiles.h"
#include "format/status.h"
#include "format/tile/coding_parameters.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tessera {

// Name and value of everything that decides the bytes of the output, in a fixed order.
using JournalFacts = std::vector<std::pair<std::string, std::string>>;

// Of a whole pass.
struct PassTotals {
    double squared_error = 0; // of sample codes
    std::uint32_t max_error = 0;
    std::uint64_t nan_count = 0, infinity_count = 0;
    std::uint64_t file_bytes = 0; // of the file it makes; 0: not known
    Statistics statistics;        // of its symbols
};

// Not thread-safe, but for the stores it gives out.
class Journal {
public:
    // Makes the folder and takes the lock. Errors: io, also where a living process holds it.
    static Result<std::unique_ptr<Journal>> open(const std::string& output);
    // Lets go of the lock; removes the folder if there is no tile in it.
    ~Journal();
    Journal(const Journal&) = delete;
    Journal& operator=(const Journal&) = delete;

    // Refuses a resume as begin() will, from the facts that are known before a texel is read: whoever
    // changed an option should not wait for trials to be told.
    Status may_resume(const JournalFacts& known) const;

    // Must come next. resume: goes on with what is there, if anything; bad_argument, naming the fact,
    // if that was begun under others. Otherwise starts anew and drops what a dead process left.
    Status begin(const JournalFacts& facts, bool resume);

    // A store for pass `number` (1 and up) with what an earlier process left of it; `figures` holds
    // one entry a tile and is filled for these.
    Result<std::unique_ptr<JournalTiles>> pass(unsigned number, const CodingParameters& parameters,
                                               std::vector<CodedTile>& figures);
    Result<std::unique_ptr<JournalTiles>> scratch(std::uint64_t tiles);

    // The totals of a pass that was finished under the same parameters.
    std::optional<PassTotals> finished(unsigned number, const CodingParameters& parameters) const;
    Status finish(unsigned number, const CodingParameters& parameters, const PassTotals& totals);
    // The tiles of this pass are not needed any more; what finish() kept stays.
    void drop(unsigned number);

    // Where the output is written before it is renamed.
    std::string output_path() const { return file("output"); }
    const std::string& folder() const { return folder_; }
    // Whether a resume under the same facts would find tiles.
    bool can_resume() const { return begun_ && holds_tiles(folder_); }
    // Whether begin() has made the journal this run's.
    bool begun() const { return begun_; }
    // After success, or where no resume can succeed: removes the folder.
    void remove();

    // Whether there are tiles, or what is known of finished passes, in such a folder.
    static bool holds_tiles(const std::string& folder);

private:
    explicit Journal(std::string folder) : folder_(std::move(folder)) {}
    Status lock();
    std::string file(const std::string& name) const { return folder_ + "/" + name; }
    std::string file(const char* kind, unsigned number) const {
        return file(kind + std::to_string(number));
    }
    static std::vector<std::string> our_files(const std::string& folder);
    void empty();

    std::string folder_;
    int lock_ = -1;
    bool begun_ = false, removed_ = false;
};

} // namespace tessera
