// dxc.exe FILE PROFILE...: compiles HLSL files to DXIL with dxcompiler.dll, entry point main(). Built by
// run.sh for Windows, because no Debian package has Microsoft's compiler. Returns the number of files
// that it refuses.
#include <windows.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

namespace {

// The parts of dxcapi.h that are needed. The order of the functions is part of the interface.
struct Source {
    const void* bytes;
    SIZE_T size;
    UINT encoding;
};
struct Blob : IUnknown {
    virtual void* STDMETHODCALLTYPE GetBufferPointer() = 0;
    virtual SIZE_T STDMETHODCALLTYPE GetBufferSize() = 0;
};
struct OperationResult : IUnknown {
    virtual HRESULT STDMETHODCALLTYPE GetStatus(HRESULT* status) = 0;
    virtual HRESULT STDMETHODCALLTYPE GetResult(Blob** result) = 0;
    virtual HRESULT STDMETHODCALLTYPE GetErrorBuffer(Blob** errors) = 0;
};
struct Compiler : IUnknown {
    virtual HRESULT STDMETHODCALLTYPE Compile(const Source* source, LPCWSTR* arguments,
                                              UINT32 count, void* includes, REFIID id,
                                              void** result) = 0;
};
const GUID compiler_class = {
    0x73e22d93, 0xe6ce, 0x47f3, {0xb5, 0xbf, 0xf0, 0x66, 0x4f, 0x39, 0xc1, 0xb0}};
const GUID compiler_id = {
    0x228b4687, 0x5a6a, 0x4730, {0x90, 0x0c, 0x97, 0x02, 0xb2, 0x20, 0x3f, 0x54}};
const GUID result_id = {
    0x58346cda, 0xdde7, 0x4497, {0x94, 0x61, 0x6f, 0x87, 0xaf, 0x5e, 0x06, 0x59}};

using Create = HRESULT(WINAPI*)(REFIID, REFIID, void**);

bool compiles(Compiler& compiler, const std::string& file, const std::string& profile) {
    std::ifstream in(file, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    const std::wstring wide(profile.begin(), profile.end());
    const Source source{text.data(), text.size(), CP_UTF8};
    LPCWSTR arguments[] = {L"-T", wide.c_str(), L"-E", L"main"};
    OperationResult* result = nullptr;
    HRESULT status = compiler.Compile(&source, arguments, 4, nullptr, result_id,
                                      reinterpret_cast<void**>(&result));
    Blob *code = nullptr, *errors = nullptr;
    if (SUCCEEDED(status)) {
        result->GetStatus(&status);
        result->GetResult(&code);
        result->GetErrorBuffer(&errors);
    }
    if (SUCCEEDED(status) && code != nullptr) {
        std::printf("%s: %u bytes of DXIL\n", file.c_str(),
                    static_cast<unsigned>(code->GetBufferSize()));
        return true;
    }
    std::printf("FAILED: %s: %s\n", file.c_str(),
                errors != nullptr ? static_cast<const char*>(errors->GetBufferPointer()) : "");
    return false;
}

} // namespace

int main(int argc, char** argv) {
    const HMODULE library = LoadLibraryA("dxcompiler.dll");
    const auto create = library == nullptr ? nullptr
                                           : reinterpret_cast<Create>(reinterpret_cast<void*>(
                                                 GetProcAddress(library, "DxcCreateInstance")));
    Compiler* compiler = nullptr;
    if (create == nullptr ||
        FAILED(create(compiler_class, compiler_id, reinterpret_cast<void**>(&compiler)))) {
        std::printf("FAILED: dxcompiler.dll cannot be loaded\n");
        return 1;
    }
    int refused = 0;
    for (int i = 1; i + 1 < argc; i += 2)
        refused += !compiles(*compiler, argv[i], argv[i + 1]);
    return refused;
}
