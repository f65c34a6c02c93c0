// Tests the bookkeeping of the tile cache against its rules and against a slow model.
#include "decoder_glsl/cache/tile_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace tessera::test {
namespace {

using Tiles = std::vector<std::uint32_t>;
constexpr std::uint32_t unlimited = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t most_tiles = 1000; // of a cache in these tests

TileCache cache_of(std::uint64_t slots, std::uint64_t tiles) {
    auto cache = TileCache::create(slots, tiles);
    EXPECT_TRUE(cache) << cache.status().message();
    return std::move(*cache);
}

// Touches tiles and returns the tiles of the jobs.
Tiles touch(TileCache& cache, const Tiles& tiles, std::uint32_t max_jobs = unlimited) {
    const auto jobs = cache.touch(tiles, max_jobs);
    EXPECT_TRUE(jobs) << jobs.status().message();
    Tiles result;
    for (const DecodeJob& job : *jobs) {
        result.push_back(job.tile);
        EXPECT_EQ(cache.slot_of(job.tile), job.slot);
        EXPECT_LT(job.slot, cache.slots());
    }
    return result;
}

Tiles frame(TileCache& cache, const Tiles& tiles, std::uint32_t max_jobs = unlimited) {
    cache.begin_frame();
    return touch(cache, tiles, max_jobs);
}

Tiles residents(const TileCache& cache) {
    Tiles tiles;
    for (std::uint32_t tile = 0; tile < most_tiles; ++tile)
        if (cache.slot_of(tile) != no_slot)
            tiles.push_back(tile);
    return tiles;
}

Tiles waiting(const TileCache& cache) {
    return {cache.waiting().begin(), cache.waiting().end()};
}

TEST(TileCache, SizesThatFit) {
    EXPECT_EQ(TileCache::create(0, 10).status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(TileCache::create((1ull << 31) + 1, 10).status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(TileCache::create(4, 1ull << 32).status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(TileCache::create(4, 1ull << 63).status().code(), ErrorCode::bad_argument);
    TileCache empty = cache_of(4, 0);
    EXPECT_EQ(frame(empty, {}), Tiles{});
    EXPECT_EQ(empty.slot_of(0), no_slot);
}

TEST(TileCache, MissingTilesGetTheFreeSlotsInOrder) {
    TileCache cache = cache_of(4, 100);
    cache.begin_frame();
    const auto jobs = cache.touch(Tiles{7, 3, 7, 99}, unlimited);
    ASSERT_TRUE(jobs);
    const std::vector<DecodeJob> want = {{7, 0}, {3, 1}, {99, 2}};
    EXPECT_TRUE(std::equal(jobs->begin(), jobs->end(), want.begin(), want.end()));
    EXPECT_EQ(residents(cache), (Tiles{3, 7, 99}));
    EXPECT_EQ(cache.slot_of(5), no_slot);
    EXPECT_EQ(cache.slot_of(100), no_slot);
    EXPECT_EQ(frame(cache, {3, 3, 7}), Tiles{});
}

TEST(TileCache, TheTileNotTouchedForLongestGoesFirst) {
    TileCache cache = cache_of(3, 10);
    frame(cache, {0});
    frame(cache, {1});
    frame(cache, {2});
    frame(cache, {0});
    EXPECT_EQ(frame(cache, {3}), Tiles{3}); // 1 is evicted
    EXPECT_EQ(residents(cache), (Tiles{0, 2, 3}));
    EXPECT_EQ(frame(cache, {4, 5}), (Tiles{4, 5})); // 2, then 0
    EXPECT_EQ(residents(cache), (Tiles{3, 4, 5}));
}

TEST(TileCache, AMissingTileNeverTakesTheSlotOfALaterOneOfTheList) {
    TileCache cache = cache_of(3, 10);
    frame(cache, {0, 1, 2});
    EXPECT_EQ(frame(cache, {5, 0, 6, 1, 7}), Tiles{5}); // only 2 may be evicted
    EXPECT_EQ(residents(cache), (Tiles{0, 1, 5}));
    EXPECT_EQ(waiting(cache), (Tiles{6, 7}));
}

TEST(TileCache, TilesOfTheFrameSurviveItsFurtherCalls) {
    TileCache cache = cache_of(2, 10);
    cache.begin_frame();
    EXPECT_EQ(touch(cache, {1}), Tiles{1});
    EXPECT_EQ(touch(cache, {2}), Tiles{2});
    EXPECT_EQ(touch(cache, {3}), Tiles{});
    EXPECT_EQ(touch(cache, {3, 1}), Tiles{});
    EXPECT_EQ(residents(cache), (Tiles{1, 2}));
    EXPECT_EQ(waiting(cache), Tiles{3});
}

TEST(TileCache, FramesThatNeedTooMuchDoNotThrash) {
    TileCache cache = cache_of(8, 64);
    std::mt19937 random(5);
    Tiles wanted(20);
    std::iota(wanted.begin(), wanted.end(), 30u);
    frame(cache, {1, 2, 3, 35, 36});
    EXPECT_EQ(frame(cache, wanted).size(), 6u);
    const Tiles held = residents(cache);
    for (int i = 0; i < 50; ++i) {
        std::shuffle(wanted.begin(), wanted.end(), random); // a GPU lists tiles in no fixed order
        EXPECT_EQ(frame(cache, wanted), Tiles{});
        EXPECT_EQ(residents(cache), held);
        EXPECT_EQ(waiting(cache).size(), 12u);
    }
    EXPECT_EQ(frame(cache, {50}), Tiles{50}) << "a frame that fits evicts again";
}

TEST(TileCache, FramesInSeveralCallsDoNotThrashEither) {
    TileCache cache = cache_of(5, 64);
    const auto play = [&] {
        cache.begin_frame();
        Tiles jobs = touch(cache, {1, 2, 3});
        for (const std::uint32_t tile : touch(cache, {4, 5, 6}))
            jobs.push_back(tile);
        return jobs;
    };
    frame(cache, {5, 6, 7, 8, 9});
    play();
    const Tiles held = residents(cache);
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(play(), Tiles{});
        EXPECT_EQ(residents(cache), held);
    }
}

TEST(TileCache, JobsAreBounded) {
    TileCache cache = cache_of(8, 64);
    const Tiles wanted = {10, 11, 12, 13, 14};
    EXPECT_EQ(frame(cache, wanted, 2), (Tiles{10, 11}));
    EXPECT_EQ(waiting(cache), (Tiles{12, 13, 14}));
    EXPECT_EQ(touch(cache, wanted, 1), Tiles{12}) << "the bound is per call";
    EXPECT_EQ(frame(cache, wanted, 2), (Tiles{13, 14}));
    EXPECT_EQ(waiting(cache), Tiles{});
    EXPECT_EQ(frame(cache, {20}, 0), Tiles{});
    EXPECT_EQ(residents(cache), wanted);
}

TEST(TileCache, FailedTilesFreeTheirSlotAndStayAway) {
    TileCache cache = cache_of(2, 10);
    frame(cache, {1, 2, 3});
    EXPECT_EQ(residents(cache), (Tiles{1, 2}));
    ASSERT_TRUE(cache.mark_failed(1));
    ASSERT_TRUE(cache.mark_failed(1));
    ASSERT_TRUE(cache.mark_failed(9)); // not resident
    EXPECT_EQ(cache.mark_failed(10).code(), ErrorCode::bad_argument);
    EXPECT_EQ(residents(cache), Tiles{2});
    EXPECT_EQ(cache.slot_of(1), no_slot);
    EXPECT_EQ(touch(cache, {1, 2, 3, 9}), Tiles{3}) << "in the slot of tile 1";
    EXPECT_EQ(frame(cache, {1, 9, 4}), Tiles{4});
    EXPECT_EQ(waiting(cache), Tiles{});
}

TEST(TileCache, TilesThatArePutOffAreAskedForInTheNextFrame) {
    TileCache cache = cache_of(2, 10);
    EXPECT_EQ(frame(cache, {1, 2, 3}), (Tiles{1, 2}));
    ASSERT_TRUE(cache.put_off(1));
    ASSERT_TRUE(cache.put_off(1));
    EXPECT_EQ(cache.put_off(10).code(), ErrorCode::bad_argument);
    EXPECT_EQ(cache.slot_of(1), no_slot);
    EXPECT_EQ(residents(cache), Tiles{2});
    EXPECT_EQ(waiting(cache), (Tiles{3, 1}));
    EXPECT_EQ(touch(cache, {1, 2, 3}), Tiles{3}) << "in the slot of tile 1, which waits";
    ASSERT_TRUE(cache.put_off(3));
    EXPECT_EQ(waiting(cache), (Tiles{3, 1}));
    EXPECT_EQ(frame(cache, {1, 2}), Tiles{1});
    EXPECT_EQ(waiting(cache), Tiles{});
    ASSERT_TRUE(cache.put_off(7)); // not resident and not touched: it is only skipped in this frame
    EXPECT_EQ(touch(cache, {7}), Tiles{});
    ASSERT_TRUE(cache.mark_failed(4));
    ASSERT_TRUE(cache.put_off(4));
    EXPECT_EQ(frame(cache, {4, 7}), Tiles{7}) << "what has failed stays failed";
    bool told = false;
    for (const PageChange& change : cache.take_changes())
        told = told || (change.tile == 3 && change.slot == no_slot);
    EXPECT_TRUE(told);
}

TEST(TileCache, TilesThatAreNotThereChangeNothing) {
    TileCache cache = cache_of(2, 10);
    frame(cache, {1});
    (void)cache.take_changes();
    cache.begin_frame();
    const auto jobs = cache.touch(Tiles{1, 2, 10}, unlimited);
    EXPECT_EQ(jobs.status().code(), ErrorCode::bad_argument);
    EXPECT_TRUE(cache.take_changes().empty());
    EXPECT_EQ(residents(cache), Tiles{1});
}

TEST(TileCache, ChangesHoldEachTileOnceInTheOrderOfTheFirst) {
    TileCache cache = cache_of(2, 10);
    frame(cache, {1, 2});
    frame(cache, {3});
    frame(cache, {1});
    const auto changes = cache.take_changes();
    const std::vector<PageChange> want = {
        {1, cache.slot_of(1)}, {2, no_slot}, {3, cache.slot_of(3)}};
    EXPECT_TRUE(std::equal(changes.begin(), changes.end(), want.begin(), want.end()));
    EXPECT_TRUE(cache.take_changes().empty());
    frame(cache, {1, 3});
    EXPECT_TRUE(cache.take_changes().empty());
}

// The rules of tile_cache.h in their simplest form: a list of resident tiles, oldest first.
struct Model {
    std::size_t slots;
    Tiles order;                                    // residents, least recently touched first
    std::map<std::uint32_t, int> last;              // frame of the last touch
    std::set<std::uint32_t> failed, waits, put_off; // waits and put_off hold for this frame
    int frame = 0;

    bool resident(std::uint32_t tile) const {
        return std::find(order.begin(), order.end(), tile) != order.end();
    }
    Tiles touch(const Tiles& tiles, std::size_t max_jobs) {
        Tiles jobs;
        for (const std::uint32_t tile : tiles)
            if (resident(tile) && last[tile] != frame) {
                std::erase(order, tile);
                order.push_back(tile);
                last[tile] = frame;
            }
        for (const std::uint32_t tile : tiles) {
            if (resident(tile) || failed.count(tile) != 0 || put_off.count(tile) != 0)
                continue;
            const bool full = order.size() == slots;
            const bool defer = jobs.size() >= max_jobs;
            if (defer || (full && last[order.front()] == frame)) {
                waits.insert(tile);
                continue;
            }
            if (full)
                order.erase(order.begin());
            order.push_back(tile);
            last[tile] = frame;
            jobs.push_back(tile);
        }
        return jobs;
    }
};

// A window that walks over a 2D field of tiles, as a camera's view does.
Tiles window(int x, int y, int width, int height, int field) {
    Tiles tiles;
    for (int j = y; j < y + height; ++j)
        for (int i = x; i < x + width; ++i)
            tiles.push_back(static_cast<std::uint32_t>(((j % field) * field) + i % field));
    return tiles;
}

TEST(TileCache, WalkingCamerasAgreeWithTheModel) {
    constexpr int field = 24;
    std::mt19937 random(99);
    const auto pick = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    for (int run = 0; run < 40; ++run) {
        SCOPED_TRACE("run " + std::to_string(run));
        const std::size_t slots = 1 + static_cast<std::size_t>(pick(60));
        TileCache cache = cache_of(slots, field * field);
        Model model{slots, {}, {}, {}, {}, {}, 0};
        std::vector<std::uint32_t> table(field * field, no_slot); // by replaying the changes
        int x = pick(field), y = pick(field), width = 3 + pick(5), height = 3 + pick(5);
        for (int step = 0; step < 200; ++step) {
            SCOPED_TRACE("step " + std::to_string(step));
            if (pick(3) != 0) { // otherwise the camera rests
                x = (x + field + pick(3) - 1) % field;
                y = (y + field + pick(3) - 1) % field;
            }
            if (pick(40) == 0)
                x = pick(field), width = 1 + pick(9);
            cache.begin_frame();
            ++model.frame;
            model.waits.clear();
            model.put_off.clear();
            for (int call = 0; call <= pick(3); ++call) {
                Tiles tiles = window(x, (y + call * height) % field, width, height, field);
                if (pick(2) == 0)
                    std::shuffle(tiles.begin(), tiles.end(), random);
                if (pick(4) == 0 && !tiles.empty())
                    tiles.push_back(tiles.front());
                const auto max_jobs =
                    pick(3) == 0 ? static_cast<std::uint32_t>(pick(8)) : unlimited;
                const Tiles jobs = touch(cache, tiles, max_jobs);
                ASSERT_EQ(jobs, model.touch(tiles, max_jobs));
                ASSERT_LE(jobs.size(), max_jobs);
                if (pick(20) != 0)
                    continue;
                for (const std::uint32_t tile : jobs) { // the network is down
                    ASSERT_TRUE(cache.put_off(tile));
                    model.put_off.insert(tile);
                    model.waits.insert(tile);
                    std::erase(model.order, tile);
                }
            }
            if (pick(30) == 0) {
                const auto tile = static_cast<std::uint32_t>(pick(field * field));
                ASSERT_TRUE(cache.mark_failed(tile));
                model.failed.insert(tile);
                std::erase(model.order, tile);
            }
            // The same tiles as the model's, each in its own slot, and no more than there are
            // slots.
            Tiles want = model.order;
            std::sort(want.begin(), want.end());
            ASSERT_EQ(residents(cache), want);
            ASSERT_LE(want.size(), slots);
            std::set<std::uint32_t> used;
            for (const std::uint32_t tile : want) {
                ASSERT_LT(cache.slot_of(tile), slots);
                ASSERT_TRUE(used.insert(cache.slot_of(tile)).second);
            }
            Tiles waits = waiting(cache);
            std::sort(waits.begin(), waits.end());
            ASSERT_EQ(waits, Tiles(model.waits.begin(), model.waits.end()));
            if (pick(4) == 0) {
                std::set<std::uint32_t> seen;
                for (const PageChange& change : cache.take_changes()) {
                    table[change.tile] = change.slot;
                    ASSERT_TRUE(seen.insert(change.tile).second);
                }
                for (std::uint32_t tile = 0; tile < table.size(); ++tile)
                    ASSERT_EQ(table[tile], cache.slot_of(tile));
            }
        }
    }
}

TEST(TileCache, TheSameCallsGiveTheSameSlots) {
    const auto play = [] {
        std::mt19937 random(3);
        TileCache cache = cache_of(50, 1000);
        std::vector<DecodeJob> all;
        for (int i = 0; i < 200; ++i) {
            cache.begin_frame();
            Tiles tiles;
            for (int k = 0; k < 30; ++k)
                tiles.push_back(random() % 1000);
            const auto jobs = cache.touch(tiles, 20);
            all.insert(all.end(), jobs->begin(), jobs->end());
        }
        return all;
    };
    EXPECT_EQ(play(), play());
}

} // namespace
} // namespace tessera::test
