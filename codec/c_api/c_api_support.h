// What both parts of the C interface share: errors, versioned structures, callbacks.
#pragma once

#include "codec/decoder.h"
#include "codec/tessera.h"
#include "format/metadata.h"
#include "format/status.h"
#include "format/texture.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <exception>
#include <functional>
#include <mutex>
#include <new>
#include <string>

namespace tessera::c_api {

inline Status bad(const std::string& what) {
    return {ErrorCode::bad_argument, what};
}

inline Status missing(const char* what) {
    return bad(std::string(what) + " is a null pointer");
}

// Returns the error code for the caller and stores the message for this thread. Never throws.
int report(const Status& status) noexcept;
int report_out_of_memory() noexcept;

// Runs `body`, a function that returns a Status, and lets no exception escape.
template <class Body> int guarded(const Body& body) noexcept {
    try {
        return report(body());
    } catch (const std::bad_alloc&) {
        return report_out_of_memory();
    } catch (const std::exception& e) {
        try {
            return report({ErrorCode::runtime, e.what()});
        } catch (...) {
            return report_out_of_memory();
        }
    } catch (...) {
        return report_out_of_memory();
    }
}

// ---- Callbacks

// Clears the message of an earlier callback on this thread.
void forget_callback_error() noexcept;
Status callback_failed(const char* which, int code);

// Calls a callback by `call` and turns its result, or what it throws, into a Status.
template <class Call> Status status_of_callback(const char* which, const Call& call) {
    forget_callback_error();
    int code = 0;
    try {
        code = call();
    } catch (...) {
        return {ErrorCode::runtime, std::string("the function ") + which + " threw an exception"};
    }
    return code == 0 ? Status() : callback_failed(which, code);
}

// A lock for callbacks that must be called one at a time. It does nothing for others.
class TurnLock {
public:
    explicit TurnLock(bool one_at_a_time) : is_on_(one_at_a_time) {}
    std::unique_lock<std::mutex> take() {
        return is_on_ ? std::unique_lock(mutex_) : std::unique_lock<std::mutex>();
    }

private:
    bool is_on_;
    std::mutex mutex_;
};

// The progress and cancelled callbacks of one call.
class Watch {
public:
    Watch(tessera_progress_function progress, tessera_cancelled_function cancelled, void* user)
        : progress_(progress), cancelled_(cancelled), user_(user) {}
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

    std::function<void(const char*, double, double)> progress_function();
    std::function<bool()> cancelled_function();
    // Whether a callback has asked to stop.
    bool is_stopped() const { return stopped_; }
    // Gives an error that results from stopping its own code.
    Status explain(const Status& status) const;

private:
    bool ask_cancelled();

    tessera_progress_function progress_;
    tessera_cancelled_function cancelled_;
    void* user_;
    std::atomic<bool> stopped_{false};
};

// ---- Structures that begin with struct_size

// A larger struct_size means that the structure was not initialised.
constexpr std::size_t largest_struct = 1u << 16;

inline Status check_struct_size(std::size_t size, const char* name) {
    if (size >= sizeof(std::size_t) && size <= largest_struct)
        return {};
    return bad(std::string(name) + ": struct_size is " + std::to_string(size) + "; call " + name +
               "_init first");
}

// Writes `value` to the structure of `size` bytes at `to` and fills a larger one with 0.
template <class T> void put_struct(T* to, std::size_t size, T value) {
    value.struct_size = size;
    std::memset(static_cast<void*>(to), 0, size);
    std::memcpy(static_cast<void*>(to), &value, std::min(size, sizeof value));
}

template <class T> void init_struct(T* to, std::size_t size, const T& defaults) noexcept {
    if (to != nullptr && size >= sizeof(std::size_t))
        put_struct(to, size, defaults);
}

// Writes a result to the caller's structure, which may be of another version.
template <class T> Status give_struct(T* to, const T& value, const char* name) {
    if (to == nullptr)
        return missing(name);
    const std::size_t size = to->struct_size;
    TESSERA_TRY(check_struct_size(size, name));
    put_struct(to, size, value);
    return {};
}

// Reads the caller's structure: fields that both sides know, and defaults for those that it lacks.
template <class T> Result<T> take_struct(const T* from, T defaults, const char* name) {
    if (from == nullptr)
        return defaults;
    std::size_t size = 0; // read separately: the structure may end right after it
    std::memcpy(&size, from, sizeof size);
    TESSERA_TRY(check_struct_size(size, name));
    const auto* bytes = reinterpret_cast<const unsigned char*>(from);
    for (std::size_t i = sizeof(T); i < size; ++i)
        if (bytes[i] != 0)
            return Status(ErrorCode::unsupported, std::string(name) + ": the member at byte " +
                                                      std::to_string(i) +
                                                      " is not known to this library (API " +
                                                      std::to_string(TESSERA_API_VERSION) + ")");
    std::memcpy(static_cast<void*>(&defaults), from, std::min(size, sizeof(T)));
    defaults.struct_size = sizeof(T);
    return defaults;
}

// ---- Enums and textures

// Converts `number` to an enum whose values are 0 to `last`.
template <class Enum> Result<Enum> take_enum(std::int32_t number, Enum last, const char* name) {
    if (number < 0 || number > static_cast<std::int32_t>(last))
        return bad(std::string(name) + " is " + std::to_string(number) + ", outside 0.." +
                   std::to_string(static_cast<std::int32_t>(last)));
    return static_cast<Enum>(number);
}

// The same for an enumeration with names: the last value is that of the last name.
template <NamedEnum Enum> Result<Enum> take_enum(std::int32_t number, const char* name) {
    return take_enum(number, static_cast<Enum>(value_names<Enum>.size() - 1), name);
}

// Takes only the type and the channels.
Result<TextureDesc> take_samples(const tessera_texture& texture);
// Takes and checks all members.
Result<TextureDesc> take_texture(const tessera_texture& texture);

// ---- Open files

const Decoder& decoder_of(const tessera_decoder& handle);

} // namespace tessera::c_api
