// Tests https:// with trusted and untrusted certificates.
#include "tests/support/test_folder.h"
#include "tools/http/http_source.h"
#include "tools/http/open_bytes.h"

#include <httplib.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <cstdlib>
#include <thread>

namespace tessera {
namespace {

using KeyPtr = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;
using CertificatePtr = std::unique_ptr<X509, decltype(&X509_free)>;

// A self-signed certificate for `alternative`, a name in the syntax of openssl.cnf
// ("IP:127.0.0.1").
CertificatePtr make_certificate(EVP_PKEY* key, const char* alternative, long valid_seconds) {
    CertificatePtr certificate(X509_new(), &X509_free);
    X509_set_version(certificate.get(), 2); // means version 3
    ASN1_INTEGER_set(X509_get_serialNumber(certificate.get()), 1);
    X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -7200);
    X509_gmtime_adj(X509_getm_notAfter(certificate.get()), valid_seconds);
    X509_set_pubkey(certificate.get(), key);
    X509_NAME* name = X509_get_subject_name(certificate.get());
    X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC,
                               reinterpret_cast<const unsigned char*>("tessera test"), -1, -1, 0);
    X509_set_issuer_name(certificate.get(), name);
    for (const auto& [id, value] : {std::pair(NID_subject_alt_name, alternative),
                                    std::pair(NID_basic_constraints, "critical,CA:TRUE")}) {
        X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, nullptr, id, value);
        X509_add_ext(certificate.get(), extension, -1);
        X509_EXTENSION_free(extension);
    }
    X509_sign(certificate.get(), key, EVP_sha256());
    return certificate;
}

// Serves 100,000 bytes at /x.tess with ranges, and a redirect to http:// at /down.tess.
class HttpsServer {
public:
    explicit HttpsServer(const char* alternative = "IP:127.0.0.1", long valid_seconds = 3600)
        : folder_(test::make_test_folder("https")), key_(EVP_RSA_gen(2048), &EVP_PKEY_free),
          certificate_(make_certificate(key_.get(), alternative, valid_seconds)),
          server_(certificate_.get(), key_.get()) {
        for (std::size_t i = 0; i < 100'000; ++i)
            file_ += static_cast<char>(i * i >> 3);
        BIO* bio = BIO_new_file(ca_file().c_str(), "w");
        PEM_write_bio_X509(bio, certificate_.get());
        BIO_free(bio);
        server_.Get("/x.tess", [this](const httplib::Request&, httplib::Response& response) {
            ++requests_;
            response.set_content(file_, "application/octet-stream");
        });
        server_.Get("/down.tess", [](const httplib::Request&, httplib::Response& response) {
            response.set_redirect("http://127.0.0.1:1/x.tess");
        });
        port_ = server_.bind_to_any_port("127.0.0.1");
        thread_ = std::thread([this] { server_.listen_after_bind(); });
        while (!server_.is_running())
            std::this_thread::yield();
    }
    ~HttpsServer() {
        server_.stop();
        thread_.join();
        std::filesystem::remove_all(folder_);
    }

    std::string url(const std::string& name = "x.tess") const {
        return "https://127.0.0.1:" + std::to_string(port_) + "/" + name;
    }
    std::string ca_file() const { return (folder_ / "ca.pem").string(); }
    const std::string& file() const { return file_; }
    int requests() const { return requests_; }

private:
    const std::filesystem::path folder_;
    std::string file_;
    std::atomic<int> requests_ = 0;
    const KeyPtr key_;
    const CertificatePtr certificate_;
    httplib::SSLServer server_;
    int port_ = 0;
    std::thread thread_;
};

// Prevents a proxy of this machine from interfering.
const bool no_proxy_for_https = ::setenv("no_proxy", "127.0.0.1", 1) == 0;

HttpOptions trusting(const HttpsServer& server) {
    HttpOptions options;
    options.ca_file = server.ca_file();
    options.back_off = std::chrono::milliseconds(5);
    return options;
}

void expect_refused(const HttpsServer& server, const HttpOptions& options,
                    const std::string& word) {
    const auto source = HttpSource::open(server.url(), options);
    ASSERT_FALSE(source.ok());
    EXPECT_EQ(source.status().code(), ErrorCode::io);
    EXPECT_NE(source.status().message().find(word), std::string::npos) << source.status().message();
    EXPECT_EQ(server.requests(), 0) << "an untrusted server got a request";
}

TEST(Https, ReadsRanges) {
    const HttpsServer server;
    const auto source = HttpSource::open(server.url(), trusting(server));
    ASSERT_TRUE(source.ok()) << source.status().message();
    EXPECT_EQ((*source)->size(), server.file().size());
    std::string part(5000, ' ');
    ASSERT_TRUE((*source)->read(70'000, std::as_writable_bytes(std::span(part))).ok());
    EXPECT_EQ(part, server.file().substr(70'000, part.size()));
    EXPECT_EQ(server.requests(), 2);
}

TEST(Https, TrustsCertificatesOfTheEnvironment) {
    const HttpsServer server;
    ::setenv("CURL_CA_BUNDLE", server.ca_file().c_str(), 1);
    const auto source = open_bytes(server.url());
    ::unsetenv("CURL_CA_BUNDLE");
    ASSERT_TRUE(source.ok()) << source.status().message();
    EXPECT_EQ((*source)->size(), server.file().size());
}

TEST(Https, RefusesASelfSignedCertificate) {
    const HttpsServer server;
    expect_refused(server, HttpOptions{}, "certificate");
}

TEST(Https, RefusesACertificateOfAnotherHost) {
    const HttpsServer server("DNS:elsewhere.example");
    expect_refused(server, trusting(server), "127.0.0.1");
}

TEST(Https, RefusesACertificateThatHasExpired) {
    const HttpsServer server("IP:127.0.0.1", -3600);
    expect_refused(server, trusting(server), "expired");
}

TEST(Https, ReportsMissingTrustedCertificates) {
    const HttpsServer server;
    HttpOptions options = trusting(server);
    options.ca_file = "/nonexistent/ca.pem";
    expect_refused(server, options, "/nonexistent/ca.pem");
}

TEST(Https, DoesNotFollowRedirectsToHttp) {
    const HttpsServer server;
    const auto source = HttpSource::open(server.url("down.tess"), trusting(server));
    ASSERT_FALSE(source.ok());
    EXPECT_NE(source.status().message().find("http"), std::string::npos);
    EXPECT_EQ(source.status().message().find("refused"), std::string::npos)
        << "the redirect was followed: " << source.status().message();
}

} // namespace
} // namespace tessera
