#include "format/io/system_calls.h"
#include "format/output_file.h"

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#include <fcntl.h>
#include <io.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace tessera::sys {

namespace {

// Its own errno, because Windows has no other number for it.
constexpr int file_in_use = ETXTBSY;

int errno_of(DWORD error) {
    switch (error) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_DRIVE:
    case ERROR_BAD_NETPATH:
        return ENOENT;
    case ERROR_INVALID_NAME:
        return EINVAL;
    case ERROR_FILENAME_EXCED_RANGE:
        return ENAMETOOLONG;
    case ERROR_ALREADY_EXISTS:
    case ERROR_FILE_EXISTS:
        return EEXIST;
    case ERROR_DISK_FULL:
    case ERROR_HANDLE_DISK_FULL:
        return ENOSPC;
    case ERROR_SHARING_VIOLATION:
    case ERROR_LOCK_VIOLATION:
        return file_in_use;
    case ERROR_DIR_NOT_EMPTY:
        return ENOTEMPTY;
    case ERROR_DIRECTORY:
        return ENOTDIR;
    case ERROR_ACCESS_DENIED:
        return EACCES;
    case ERROR_WRITE_PROTECT:
        return EROFS;
    case ERROR_TOO_MANY_OPEN_FILES:
        return EMFILE;
    case ERROR_NOT_ENOUGH_MEMORY:
    case ERROR_OUTOFMEMORY:
        return ENOMEM;
    default:
        return EIO;
    }
}

int failed() {
    errno = errno_of(GetLastError());
    return -1;
}

std::wstring utf16_of(const std::string& text) {
    const int bytes = static_cast<int>(text.size());
    const int count = MultiByteToWideChar(CP_UTF8, 0, text.data(), bytes, nullptr, 0);
    std::wstring wide(static_cast<std::size_t>(std::max(count, 0)), L'\0');
    MultiByteToWideChar(CP_UTF8, 0, text.data(), bytes, wide.data(), count);
    return wide;
}

// Paths near the limit of 260 characters become absolute and get the prefix that lifts the limit.
std::wstring wide(const std::string& path) {
    constexpr std::size_t longest_plain = 240; // leaves room for the name of a temporary file
    const std::wstring text = utf16_of(path);
    const DWORD length = GetFullPathNameW(text.c_str(), 0, nullptr, nullptr); // with the final zero
    if (length <= longest_plain && !text.starts_with(L"\\\\?\\"))
        return text;
    // Behind the prefix only backslashes separate names.
    std::wstring full(length, L'\0');
    full.resize(GetFullPathNameW(text.c_str(), length, full.data(), nullptr));
    if (full.starts_with(L"\\\\?\\")) {
        std::ranges::replace(full, L'/', L'\\');
        return full;
    }
    return full.starts_with(L"\\\\") ? L"\\\\?\\UNC" + full.substr(1) : L"\\\\?\\" + full;
}

HANDLE handle_of(int descriptor) {
    return reinterpret_cast<HANDLE>(_get_osfhandle(descriptor));
}

constexpr DWORD share_all = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;

OVERLAPPED place_of(std::uint64_t offset) {
    OVERLAPPED place = {};
    place.Offset = static_cast<DWORD>(offset);
    place.OffsetHigh = static_cast<DWORD>(offset >> 32);
    return place;
}

// A call moves at most this many bytes.
DWORD piece_of(std::size_t bytes) {
    return static_cast<DWORD>(std::min(bytes, std::size_t{1} << 30));
}

int set_facts(HANDLE file, FileFacts& facts) {
    using Kind = FileFacts::Kind;
    facts.kind = Kind::other;
    if (GetFileType(file) != FILE_TYPE_DISK)
        return 0;
    BY_HANDLE_FILE_INFORMATION info = {};
    if (!GetFileInformationByHandle(file, &info))
        return failed();
    facts.kind =
        (info.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0 ? Kind::folder : Kind::file;
    facts.size = std::uint64_t{info.nFileSizeHigh} << 32 | info.nFileSizeLow;
    facts.device = info.dwVolumeSerialNumber;
    facts.number = std::uint64_t{info.nFileIndexHigh} << 32 | info.nFileIndexLow;
    constexpr std::int64_t units_per_second = 10'000'000, seconds_to_1970 = 11'644'473'600;
    const auto units =
        static_cast<std::int64_t>(std::uint64_t{info.ftLastWriteTime.dwHighDateTime} << 32 |
                                  info.ftLastWriteTime.dwLowDateTime);
    facts.seconds = units / units_per_second - seconds_to_1970;
    facts.nanoseconds = units % units_per_second * 100;
    facts.read_only = (info.dwFileAttributes & FILE_ATTRIBUTE_READONLY) != 0;
    return 0;
}

// Opens a file or a folder for its attributes or, with DELETE, as if to replace it.
HANDLE open_to_look(const std::string& path, DWORD access) {
    return CreateFileW(wide(path).c_str(), access, share_all, nullptr, OPEN_EXISTING,
                       FILE_FLAG_BACKUP_SEMANTICS, nullptr);
}

} // namespace

int open(const std::string& path, Access access) {
    const bool writes = access == Access::create || access == Access::update;
    if (writes && is_made_to_fail(Call::open))
        return -1;
    const DWORD wanted = access == Access::create   ? GENERIC_WRITE
                         : access == Access::update ? GENERIC_READ | GENERIC_WRITE
                                                    : GENERIC_READ;
    const DWORD how = access == Access::create   ? CREATE_NEW
                      : access == Access::update ? OPEN_ALWAYS
                                                 : OPEN_EXISTING;
    // A folder can be opened only so, and is then refused by its kind.
    DWORD flags = writes ? FILE_ATTRIBUTE_NORMAL : FILE_FLAG_BACKUP_SEMANTICS;
    if (access == Access::update || access == Access::read_no_link)
        flags |= FILE_FLAG_OPEN_REPARSE_POINT;
    const HANDLE file =
        CreateFileW(wide(path).c_str(), wanted, share_all, nullptr, how, flags, nullptr);
    if (file == INVALID_HANDLE_VALUE)
        return failed();
    BY_HANDLE_FILE_INFORMATION info = {};
    if ((flags & FILE_FLAG_OPEN_REPARSE_POINT) != 0 && GetFileInformationByHandle(file, &info) &&
        (info.dwFileAttributes & FILE_ATTRIBUTE_REPARSE_POINT) != 0) {
        CloseHandle(file);
        errno = ELOOP;
        return -1;
    }
    const int descriptor = _open_osfhandle(reinterpret_cast<std::intptr_t>(file),
                                           _O_BINARY | _O_NOINHERIT | (writes ? 0 : _O_RDONLY));
    if (descriptor < 0)
        CloseHandle(file);
    return descriptor;
}

int close(int descriptor) {
    const int result = _close(descriptor);
    return is_made_to_fail(Call::close) ? -1 : result;
}

void drop(int descriptor) {
    _close(descriptor);
}

std::int64_t read_at(int descriptor, std::span<std::byte> out, std::uint64_t offset) {
    OVERLAPPED place = place_of(offset);
    DWORD count = 0;
    if (ReadFile(handle_of(descriptor), out.data(), piece_of(out.size()), &count, &place))
        return count;
    return GetLastError() == ERROR_HANDLE_EOF ? 0 : failed();
}

std::int64_t write_at(int descriptor, std::span<const std::byte> bytes, std::uint64_t offset) {
    if (is_made_to_fail(Call::write))
        return -1;
    OVERLAPPED place = place_of(offset);
    DWORD count = 0;
    if (WriteFile(handle_of(descriptor), bytes.data(), piece_of(bytes.size()), &count, &place))
        return count;
    return failed();
}

int truncate(int descriptor, std::uint64_t length) {
    if (is_made_to_fail(Call::truncate))
        return -1;
    errno = _chsize_s(descriptor, static_cast<std::int64_t>(length));
    return errno == 0 ? 0 : -1;
}

int sync(int descriptor) {
    if (is_made_to_fail(Call::sync))
        return -1;
    return FlushFileBuffers(handle_of(descriptor)) ? 0 : failed();
}

int rename(const std::string& from, const std::string& to) {
    if (is_made_to_fail(Call::rename))
        return -1;
    if (MoveFileExW(wide(from).c_str(), wide(to).c_str(), MOVEFILE_REPLACE_EXISTING))
        return 0;
    const int result = failed();
    if (errno != EACCES)
        return result;
    // Windows denies the access also if another process has the file open. Say which it is.
    const HANDLE target = open_to_look(to, DELETE);
    if (target != INVALID_HANDLE_VALUE)
        CloseHandle(target);
    errno = target == INVALID_HANDLE_VALUE && GetLastError() == ERROR_SHARING_VIOLATION
                ? file_in_use
                : EACCES;
    return -1;
}

int make_folder(const std::string& path) {
    if (is_made_to_fail(Call::make_folder))
        return -1;
    return CreateDirectoryW(wide(path).c_str(), nullptr) ? 0 : failed();
}

int remove_file(const std::string& path) {
    return DeleteFileW(wide(path).c_str()) ? 0 : failed();
}

int remove_empty_folder(const std::string& path) {
    return RemoveDirectoryW(wide(path).c_str()) ? 0 : failed();
}

int list_folder(const std::string& path, std::vector<std::string>& names) {
    names.clear();
    WIN32_FIND_DATAW found = {};
    const HANDLE search = FindFirstFileW(wide(path + "\\*").c_str(), &found);
    if (search == INVALID_HANDLE_VALUE)
        return failed();
    do
        if (const std::wstring name = found.cFileName; name != L"." && name != L"..")
            names.push_back(std::filesystem::path(name).string());
    while (FindNextFileW(search, &found));
    const DWORD error = GetLastError();
    FindClose(search);
    errno = errno_of(error);
    return error == ERROR_NO_MORE_FILES ? 0 : -1;
}

int remove_tree(const std::string& path) {
    const DWORD attributes = GetFileAttributesW(wide(path).c_str());
    if (attributes == INVALID_FILE_ATTRIBUTES)
        return GetLastError() == ERROR_FILE_NOT_FOUND ? 0 : failed();
    if ((attributes & FILE_ATTRIBUTE_DIRECTORY) == 0)
        return remove_file(path);
    std::vector<std::string> names;
    if ((attributes & FILE_ATTRIBUTE_REPARSE_POINT) == 0 && list_folder(path, names) < 0)
        return -1;
    for (const std::string& name : names)
        if (remove_tree(path + "\\" + name) < 0)
            return -1;
    return remove_empty_folder(path);
}

int facts_of(int descriptor, FileFacts& facts) {
    return set_facts(handle_of(descriptor), facts);
}

int facts_of(const std::string& path, FileFacts& facts) {
    const HANDLE file = open_to_look(path, FILE_READ_ATTRIBUTES);
    if (file == INVALID_HANDLE_VALUE)
        return failed();
    const int result = set_facts(file, facts);
    CloseHandle(file);
    return result;
}

bool is_other_than_folder(const std::string& path) {
    const DWORD attributes = GetFileAttributesW(wide(path).c_str());
    return attributes != INVALID_FILE_ATTRIBUTES &&
           ((attributes & FILE_ATTRIBUTE_DIRECTORY) == 0 ||
            (attributes & FILE_ATTRIBUTE_REPARSE_POINT) != 0);
}

Lock lock(int descriptor) {
    OVERLAPPED place = place_of(std::uint64_t{1} << 62); // a byte that nobody reads
    if (LockFileEx(handle_of(descriptor), LOCKFILE_EXCLUSIVE_LOCK | LOCKFILE_FAIL_IMMEDIATELY, 0, 1,
                   0, &place))
        return Lock::taken;
    const DWORD error = GetLastError();
    errno = errno_of(error);
    return error == ERROR_LOCK_VIOLATION || error == ERROR_IO_PENDING ? Lock::held_by_another
                                                                      : Lock::failed;
}

// Files inherit their access rights from the folder.
void keep_mode_and_owner(int, const std::string&) {}
void keep_mode_and_owner(const std::string&, const std::string&) {}

std::uint64_t process_id() {
    return GetCurrentProcessId();
}

std::string reason(int error) {
    if (error == file_in_use)
        return "another process has the file open";
    return std::generic_category().message(error);
}

} // namespace tessera::sys

namespace tessera {

std::filesystem::path to_path(const std::string& utf8) {
    return sys::wide(utf8);
}

} // namespace tessera
