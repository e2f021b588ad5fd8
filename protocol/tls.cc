#include "protocol/tls.h"

#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "protocol/openssl.h"

namespace visum::protocol {
namespace {

struct Free {
  void operator()(SSL_CTX* context) const { openssl().SSL_CTX_free(context); }
  void operator()(SSL* ssl) const { openssl().SSL_free(ssl); }
};
using SslContext = std::unique_ptr<SSL_CTX, Free>;
using Ssl = std::unique_ptr<SSL, Free>;

constexpr int kAlertReasons = 1000;  // OpenSSL counts the reasons of a peer's alerts from here (ssl.h)

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

// The newest error of this thread as text. Clears all of the thread's errors.
std::string last_error() {
  const auto code = openssl().ERR_peek_last_error();
  openssl().ERR_clear_error();
  const char* reason = openssl().ERR_reason_error_string(code);
  return reason ? reason : "the reason is unknown";
}

[[noreturn]] void fail(const std::string& file, const std::string& what) {
  throw std::runtime_error(file + ": " + what);
}

void check_key_file(const std::string& file) {
  struct stat info {};
  if (::stat(file.c_str(), &info) != 0) fail(file, "the private key cannot be read");
  if ((info.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    fail(file, "others may read the private key; chmod 600 makes it yours alone");
}

SslContext make_context(const TlsFiles& files, TlsContext::Side side) {
  if (files.authority.empty() || files.certificate.empty() || files.key.empty())
    throw std::runtime_error("TLS needs three files: an authority's certificate, a certificate, its key");
  const bool server = side == TlsContext::Side::kServer;
  SslContext context(
      openssl().SSL_CTX_new(server ? openssl().TLS_server_method() : openssl().TLS_client_method()));
  if (!context) throw std::runtime_error("TLS: " + last_error());
  SSL_CTX* ssl = context.get();
  openssl().SSL_CTX_ctrl(ssl, SSL_CTRL_SET_MIN_PROTO_VERSION, TLS1_3_VERSION, nullptr);
  if (openssl().SSL_CTX_load_verify_file(ssl, files.authority.c_str()) != 1)
    fail(files.authority, "holds no certificate of an authority: " + last_error());
  if (openssl().SSL_CTX_use_certificate_chain_file(ssl, files.certificate.c_str()) != 1)
    fail(files.certificate, "holds no certificate: " + last_error());
  check_key_file(files.key);
  if (openssl().SSL_CTX_use_PrivateKey_file(ssl, files.key.c_str(), SSL_FILETYPE_PEM) != 1)
    fail(files.key, "holds no private key of the certificate in " + files.certificate + ": " + last_error());
  openssl().SSL_CTX_set_verify(ssl, SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, nullptr);
  // No session is resumed: each connection must show its certificate.
  openssl().SSL_CTX_ctrl(ssl, SSL_CTRL_SET_SESS_CACHE_MODE, SSL_SESS_CACHE_OFF, nullptr);
  openssl().SSL_CTX_set_num_tickets(ssl, 0);
  openssl().SSL_CTX_ctrl(ssl, SSL_CTRL_MODE,
                         SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER, nullptr);
  return context;
}

// Tells the server which of its names the client wants, as SSL_set_tlsext_host_name() does.
long set_server_name(SSL* ssl, std::string host) {
  return openssl().SSL_ctrl(ssl, SSL_CTRL_SET_TLSEXT_HOSTNAME, TLSEXT_NAMETYPE_host_name, host.data());
}

// The text for the alert with which the peer gave up.
std::string alert_text(int alert) {
  switch (alert) {
    case SSL_AD_CERTIFICATE_EXPIRED:
      return "our certificate has expired";
    case SSL_AD_UNKNOWN_CA:
      return "our certificate is of an authority that it does not know";
    case SSL_AD_BAD_CERTIFICATE:
    case SSL_AD_UNSUPPORTED_CERTIFICATE:
    case SSL_AD_CERTIFICATE_REVOKED:
    case SSL_AD_CERTIFICATE_UNKNOWN:
      return "it does not accept our certificate";
    case TLS13_AD_CERTIFICATE_REQUIRED:
      return "it wants a certificate";
    case SSL_AD_PROTOCOL_VERSION:
      return "it does not speak the same version of TLS";
    default:
      return openssl().SSL_alert_desc_string_long(alert);
  }
}

}  // namespace

TlsFiles tls_files_of_environment() {
  return {environment("VISUM_TLS_CA"), environment("VISUM_TLS_CERT"), environment("VISUM_TLS_KEY")};
}

bool looks_like_tls(std::span<const std::byte> first) {
  constexpr std::byte kHandshake{0x16}, kMajorVersion{0x03};
  return first.empty() || (first[0] == kHandshake && (first.size() == 1 || first[1] == kMajorVersion));
}

struct TlsContext::Impl {
  SslContext ssl;
  Side side;
};

TlsContext::TlsContext(const TlsFiles& files, Side side)
    : impl_(std::make_unique<Impl>(Impl{make_context(files, side), side})) {}

TlsContext::~TlsContext() = default;

struct TlsStream::Impl {
  Ssl ssl;
  BIO* in;   // bytes from the network; `ssl` owns it
  BIO* out;  // bytes for the network; `ssl` owns it
  bool server;
};

TlsStream::TlsStream(const TlsContext& context, const std::string& host)
    : impl_(std::make_unique<Impl>(
          Impl{Ssl(openssl().SSL_new(context.impl_->ssl.get())), openssl().BIO_new(openssl().BIO_s_mem()),
               openssl().BIO_new(openssl().BIO_s_mem()), context.impl_->side == TlsContext::Side::kServer})) {
  SSL* ssl = impl_->ssl.get();
  if (!ssl || !impl_->in || !impl_->out) throw std::bad_alloc();
  openssl().SSL_set_bio(ssl, impl_->in, impl_->out);
  if (impl_->server) {
    openssl().SSL_set_accept_state(ssl);
    return;
  }
  openssl().SSL_set_connect_state(ssl);
  if (openssl().X509_VERIFY_PARAM_set1_ip_asc(openssl().SSL_get0_param(ssl), host.c_str()) == 1) return;
  openssl().ERR_clear_error();
  if (openssl().SSL_set1_host(ssl, host.c_str()) != 1 || set_server_name(ssl, host) != 1)
    throw std::runtime_error("'" + host + "' is not a server's name: " + last_error());
}

TlsStream::~TlsStream() = default;

void TlsStream::feed(std::span<const std::byte> bytes) {
  if (!bytes.empty()) openssl().BIO_write(impl_->in, bytes.data(), static_cast<int>(bytes.size()));
}

// A good result, or one that wants more bytes, needs no note.
void TlsStream::note(int result) {
  if (result > 0) return;
  SSL* ssl = impl_->ssl.get();
  switch (openssl().SSL_get_error(ssl, result)) {
    case SSL_ERROR_WANT_READ:
    case SSL_ERROR_WANT_WRITE:
      return;
    case SSL_ERROR_ZERO_RETURN:
      ended_ = true;
      return;
    default:
      break;
  }
  const int reason = ERR_GET_REASON(openssl().ERR_peek_error());
  const std::string peer = impl_->server ? "the client" : "the server";
  if (const auto verdict = openssl().SSL_get_verify_result(ssl); verdict != X509_V_OK)
    failure_ = peer + "'s certificate is not accepted: " + openssl().X509_verify_cert_error_string(verdict);
  else if (reason == SSL_R_PEER_DID_NOT_RETURN_A_CERTIFICATE)
    failure_ = peer + " shows no certificate";
  else if (reason >= kAlertReasons)
    failure_ = peer + " ends it: " + alert_text(reason - kAlertReasons);
  else
    failure_ = "no TLS with " + peer + ": " + last_error();
  openssl().ERR_clear_error();
}

bool TlsStream::advance() {
  if (established()) return true;
  if (!failure_.empty()) return false;
  openssl().ERR_clear_error();
  note(openssl().SSL_do_handshake(impl_->ssl.get()));
  return established() && failure_.empty();
}

std::size_t TlsStream::read(std::span<std::byte> into) {
  if (ended_ || !advance() || !failure_.empty() || into.empty()) return 0;
  openssl().ERR_clear_error();
  std::size_t got = 0;
  const int result = openssl().SSL_read_ex(impl_->ssl.get(), into.data(), into.size(), &got);
  note(result);
  return result > 0 ? got : 0;
}

std::size_t TlsStream::write(std::span<const std::byte> bytes) {
  if (!advance() || !failure_.empty() || bytes.empty()) return 0;
  openssl().ERR_clear_error();
  std::size_t taken = 0;
  const int result = openssl().SSL_write_ex(impl_->ssl.get(), bytes.data(), bytes.size(), &taken);
  note(result);
  return result > 0 ? taken : 0;
}

void TlsStream::finish() {
  if (established() && failure_.empty()) openssl().SSL_shutdown(impl_->ssl.get());
  openssl().ERR_clear_error();
}

std::span<const std::byte> TlsStream::pending() {
  if (sent_ == out_.size()) {
    out_.resize(openssl().BIO_ctrl_pending(impl_->out));
    sent_ = 0;
    if (!out_.empty()) openssl().BIO_read(impl_->out, out_.data(), static_cast<int>(out_.size()));
  }
  return std::span<const std::byte>(out_).subspan(sent_);
}

void TlsStream::sent(std::size_t bytes) {
  sent_ += bytes;
}

bool TlsStream::established() const {
  return openssl().SSL_is_init_finished(impl_->ssl.get()) == 1;
}

std::string TlsStream::peer_name() const {
  const X509* certificate = openssl().SSL_get0_peer_certificate(impl_->ssl.get());
  if (!certificate) return {};
  const X509_NAME* subject = openssl().X509_get_subject_name(certificate);
  const int place = openssl().X509_NAME_get_index_by_NID(subject, NID_commonName, -1);
  if (place < 0) return {};
  unsigned char* text = nullptr;
  const int size = openssl().ASN1_STRING_to_UTF8(
      &text, openssl().X509_NAME_ENTRY_get_data(openssl().X509_NAME_get_entry(subject, place)));
  if (size < 0) return {};
  const std::string name(reinterpret_cast<const char*>(text), static_cast<std::size_t>(size));
  openssl().CRYPTO_free(text, OPENSSL_FILE, OPENSSL_LINE);
  return name;
}

}  // namespace visum::protocol
