#include "tools/support/system.h"

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#include <shellapi.h>

#include <fcntl.h>
#include <io.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <thread>

namespace tessera {
namespace {

HANDLE first_signal = nullptr; // an event
void (*interrupt_handler)(int) = nullptr;

std::string utf8_of(std::wstring_view text) {
    const int length = static_cast<int>(text.size());
    const int bytes =
        WideCharToMultiByte(CP_UTF8, 0, text.data(), length, nullptr, 0, nullptr, nullptr);
    std::string utf8(static_cast<std::size_t>(std::max(bytes, 0)), '\0');
    WideCharToMultiByte(CP_UTF8, 0, text.data(), length, utf8.data(), bytes, nullptr, nullptr);
    return utf8;
}

// Windows calls it on a thread of its own.
BOOL WINAPI handle_console_event(DWORD event) {
    interrupt_handler(event == CTRL_C_EVENT ? SIGINT : SIGTERM);
    return TRUE;
}

} // namespace

// argv is in the code page of the system, which has few of the characters that a name may have.
std::vector<std::string> command_line(int argc, char** argv) {
    int count = 0;
    LPWSTR* const words = CommandLineToArgvW(GetCommandLineW(), &count);
    if (words == nullptr)
        return {argv, argv + argc};
    std::vector<std::string> line;
    for (int i = 0; i < count; ++i)
        line.push_back(utf8_of(words[i]));
    LocalFree(words);
    return line;
}

bool is_terminal(StandardStream stream) {
    DWORD mode = 0; // _isatty() also says yes to NUL
    return GetConsoleMode(reinterpret_cast<HANDLE>(_get_osfhandle(static_cast<int>(stream))),
                          &mode) != 0;
}

void set_up_standard_streams() {
    _setmode(0, _O_BINARY);
    _setmode(1, _O_BINARY);
    _setmode(2, _O_BINARY);
    SetConsoleOutputCP(CP_UTF8);
    for (const int stream : {1, 2}) { // lets the progress bar clear its line
        const HANDLE console = reinterpret_cast<HANDLE>(_get_osfhandle(stream));
        DWORD mode = 0;
        if (GetConsoleMode(console, &mode))
            SetConsoleMode(console, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
    }
}

std::string file_of_standard_input() {
    const HANDLE input = GetStdHandle(STD_INPUT_HANDLE);
    if (GetFileType(input) != FILE_TYPE_DISK)
        return "";
    const DWORD length = GetFinalPathNameByHandleW(input, nullptr, 0, VOLUME_NAME_DOS);
    std::wstring name(length, L'\0');
    name.resize(GetFinalPathNameByHandleW(input, name.data(), length, VOLUME_NAME_DOS));
    return utf8_of(name);
}

std::int64_t read_standard_input(std::span<std::byte> out) {
    constexpr std::size_t most = std::size_t{1} << 20;
    return _read(0, out.data(), static_cast<unsigned>(std::min(out.size(), most)));
}

void write_standard_error(std::string_view words) {
    _write(2, words.data(), static_cast<unsigned>(words.size()));
}

void handle_interrupts(void (*handler)(int signal), void (*watcher)()) {
    interrupt_handler = handler;
    first_signal = CreateEventW(nullptr, TRUE, FALSE, nullptr);
    try {
        std::thread(watcher).detach();
    } catch (const std::exception&) { // without the watcher, commands end when they check
    }
    SetConsoleCtrlHandler(handle_console_event, TRUE);
}

void wake_watcher() {
    SetEvent(first_signal);
}

void wait_for_wake() {
    WaitForSingleObject(first_signal, INFINITE);
}

void exit_at_once(int code) {
    TerminateProcess(GetCurrentProcess(), static_cast<UINT>(code));
    std::abort();
}

void end_by_signal(int) {
    exit_at_once(static_cast<int>(STATUS_CONTROL_C_EXIT));
}

// Only an attempt could tell; the first file that is made tells as well.
std::string why_not_writable(const std::filesystem::path&) {
    return "";
}

bool is_writable(const std::filesystem::path& file) {
    return _waccess(file.c_str(), 2) == 0;
}

bool is_reserved(const std::filesystem::path& file) {
    std::string name = file.filename().string();
    name = name.substr(0, name.find('.')); // an ending does not matter
    name = name.substr(0, name.find_last_not_of(' ') + 1);
    std::ranges::transform(name, name.begin(),
                           [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    const bool is_numbered =
        name.size() == 4 && (name.starts_with("COM") || name.starts_with("LPT"));
    return name == "CON" || name == "PRN" || name == "AUX" || name == "NUL" ||
           (is_numbered && name[3] >= '1' && name[3] <= '9');
}

std::optional<FileStamp> stamp_of(const std::filesystem::path& file) {
    const HANDLE opened = CreateFileW(file.c_str(), FILE_READ_ATTRIBUTES,
                                      FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                                      nullptr, OPEN_EXISTING, 0, nullptr);
    if (opened == INVALID_HANDLE_VALUE) // among others, of a folder
        return std::nullopt;
    BY_HANDLE_FILE_INFORMATION info = {};
    const bool is_file =
        GetFileType(opened) == FILE_TYPE_DISK && GetFileInformationByHandle(opened, &info) != 0;
    CloseHandle(opened);
    if (!is_file)
        return std::nullopt;
    constexpr std::int64_t units_per_second = 10'000'000, seconds_to_1970 = 11'644'473'600;
    const auto units =
        static_cast<std::int64_t>(std::uint64_t{info.ftLastWriteTime.dwHighDateTime} << 32 |
                                  info.ftLastWriteTime.dwLowDateTime);
    return FileStamp{std::uint64_t{info.nFileSizeHigh} << 32 | info.nFileSizeLow,
                     units / units_per_second - seconds_to_1970, units % units_per_second * 100};
}

std::byte* allocate_slab(std::size_t bytes) {
    return static_cast<std::byte*>(std::malloc(bytes));
}

void free_slab(std::byte* memory) {
    std::free(memory);
}

void open_in_browser(const std::string& url) {
    ShellExecuteA(nullptr, "open", url.c_str(), nullptr, nullptr, SW_SHOWNORMAL);
}

} // namespace tessera
