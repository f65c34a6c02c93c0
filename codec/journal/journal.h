// What an encode keeps beside its output so that it can be resumed after a kill: a folder
// "<output>.journal" with
//   lock      locked by the process that encodes
//   head      what is encoded and how; a resume of something else is refused
//   pass-N    the tiles of pass N (journal_tiles.h) as long as they may be needed
//   done-N    the totals of a finished pass, so that rate control need not repeat it
//   fitted-N  payloads under fitted tables; nameless, made again after a resume
//   output    the output file until it is renamed
// Rate control is deterministic, so a resumed run asks for the same passes in the same order and
// finds the finished ones here. Files are little-endian and end with a CRC32C. A file that is torn,
// damaged or of another pass counts as missing, and nothing in it is trusted. Files are not synced
// to the disk: a power failure may cost tiles, which the checksums detect.
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

// Names and values of everything that decides the bytes of the output, in a fixed order.
using JournalFacts = std::vector<std::pair<std::string, std::string>>;

// Totals of a pass over the whole texture.
struct PassTotals {
    double squared_error = 0; // of sample codes
    std::uint32_t max_error = 0;
    std::uint64_t nan_count = 0, infinity_count = 0;
    std::uint64_t file_bytes = 0; // of the file that the pass makes; 0: not known
    Statistics statistics;        // of its symbols
};

// Not thread-safe, except for the stores it returns.
class Journal {
public:
    // Makes the folder and takes the lock. Errors: io, also if a running process holds the lock.
    static Result<std::unique_ptr<Journal>> open(const std::string& output);
    // Releases the lock; removes the folder if it holds no tile.
    ~Journal();
    Journal(const Journal&) = delete;
    Journal& operator=(const Journal&) = delete;

    // Refuses a resume as begin() would, from the facts that are known before a texel is read, so
    // that nobody waits for trials only to learn that an option differs.
    Status may_resume(const JournalFacts& known) const;

    // Must be called before the functions below. resume: continues with what is there;
    // bad_argument, with the first differing fact, if that was begun under other facts. Otherwise
    // deletes what an earlier process left.
    Status begin(const JournalFacts& facts, bool resume);

    // A store for pass `number` (1 and up) with what an earlier process left of it. Fills
    // `figures`, one per tile, for these tiles.
    Result<std::unique_ptr<JournalTiles>> pass(unsigned number, const CodingParameters& parameters,
                                               std::vector<CodedTile>& figures);
    // A store for payloads under fitted tables.
    Result<std::unique_ptr<JournalTiles>> scratch(std::uint64_t tiles);

    // The totals of a pass that was finished with the same parameters.
    std::optional<PassTotals> finished(unsigned number, const CodingParameters& parameters) const;
    Status finish(unsigned number, const CodingParameters& parameters, const PassTotals& totals);
    // Deletes the tiles of a pass; its totals stay.
    void drop(unsigned number);

    // Where the output is written before it is renamed.
    std::string output_path() const { return file("output"); }
    const std::string& folder() const { return folder_; }
    // Whether a resume under the same facts would find tiles.
    bool can_resume() const { return begun_ && holds_tiles(folder_); }
    // Whether begin() succeeded.
    bool begun() const { return begun_; }
    // Removes the folder: after success, or where no resume can succeed.
    void remove();

    // Whether such a folder holds tiles or totals.
    static bool holds_tiles(const std::string& folder);

private:
    explicit Journal(std::string folder) : folder_(std::move(folder)) {}
    Status lock();
    std::string file(const std::string& name) const { return folder_ + "/" + name; }
    std::string file(const char* kind, unsigned number) const {
        return file(kind + std::to_string(number));
    }
    Status refuse_resume(const std::string& difference) const;
    static std::vector<std::string> our_files(const std::string& folder);
    void empty();

    std::string folder_;
    int lock_ = -1;
    unsigned scratches_ = 0; // Windows keeps the name of a removed file until it is closed
    bool begun_ = false, removed_ = false;
};

} // namespace tessera
