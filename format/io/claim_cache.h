// A bounded cache for several threads in which each value is loaded by one of them.
#pragma once

#include "format/status.h"

#include <condition_variable>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <utility>

namespace tessera {

// Keeps the values that were used last, up to a total cost of `capacity`. A thread claims a key
// before it loads the value, and other threads that need the value wait for that load instead of
// repeating it. If the load fails, one of the waiting threads tries again. All members are
// thread-safe.
template <class T> class ClaimCache {
public:
    using Value = std::shared_ptr<const T>;
    using Cost = std::uint64_t (*)(const T&);
    ClaimCache(std::uint64_t capacity, Cost cost) : capacity_(capacity), cost_(cost) {}
    ClaimCache(const ClaimCache&) = delete;
    ClaimCache& operator=(const ClaimCache&) = delete;

    // The exclusive right to load the value of a key. The holder must either fulfil the claim or
    // destroy it, which gives up the key.
    class Claim {
    public:
        Claim(ClaimCache& cache, std::uint64_t key) : cache_(&cache), key_(key) {}
        Claim(Claim&& other) noexcept
            : cache_(std::exchange(other.cache_, nullptr)), key_(other.key_) {}
        Claim& operator=(Claim&&) = delete;
        ~Claim() {
            if (cache_ != nullptr)
                cache_->give_up(key_);
        }
        Value fulfil(T value) {
            auto shared = std::make_shared<const T>(std::move(value));
            cache_->store(key_, shared); // if it throws, it has changed nothing
            cache_ = nullptr;
            return shared;
        }

    private:
        ClaimCache* cache_;
        std::uint64_t key_;
    };

    // The cached value, or the value that load() returns as a Result<T>. Errors: those of load().
    template <class Load> Result<Value> get(std::uint64_t key, const Load& load) {
        std::unique_lock lock(mutex_);
        for (auto found = entries_.find(key); found != entries_.end(); found = entries_.find(key)) {
            if (found->second.value != nullptr) {
                touch(found->second);
                return found->second.value;
            }
            changed_.wait(lock);
        }
        entries_.try_emplace(key);
        lock.unlock();
        Claim claim(*this, key);
        TESSERA_TRY_ASSIGN(T loaded, load());
        return claim.fulfil(std::move(loaded));
    }

    // Claims a key. Returns nothing if its value is cached, which counts as a use, or is being
    // loaded. It never waits, so a thread may hold many claims.
    std::optional<Claim> claim(std::uint64_t key) {
        const std::lock_guard lock(mutex_);
        const auto [entry, added] = entries_.try_emplace(key);
        if (added)
            return Claim(*this, key);
        if (entry->second.value != nullptr)
            touch(entry->second);
        return std::nullopt;
    }

private:
    struct Entry {
        Value value; // null: claimed
        std::list<std::uint64_t>::iterator use;
    };

    void touch(Entry& entry) { uses_.splice(uses_.begin(), uses_, entry.use); }

    void store(std::uint64_t key, const Value& value) {
        const std::lock_guard lock(mutex_);
        uses_.push_front(key);
        Entry& entry = entries_.at(key);
        entry.value = value;
        entry.use = uses_.begin();
        held_ += cost_(*value);
        while (held_ > capacity_ && uses_.size() > 1) {
            const auto oldest = entries_.find(uses_.back());
            held_ -= cost_(*oldest->second.value);
            entries_.erase(oldest);
            uses_.pop_back();
        }
        changed_.notify_all();
    }

    void give_up(std::uint64_t key) {
        const std::lock_guard lock(mutex_);
        entries_.erase(key);
        changed_.notify_all();
    }

    const std::uint64_t capacity_;
    const Cost cost_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::unordered_map<std::uint64_t, Entry> entries_;
    std::list<std::uint64_t> uses_; // keys of loaded entries; the one used last is first
    std::uint64_t held_ = 0;        // total cost of the loaded entries
};

} // namespace tessera
