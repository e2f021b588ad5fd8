#include "tests/protocol/certificates.h"

#include <openssl/ec.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <memory>
#include <stdexcept>

namespace visum::testing {
namespace {

constexpr long kDay_s = 24 * 3600;

struct Pem {
  std::string certificate, key;
};

void need(bool good) {
  if (!good) throw std::runtime_error("OpenSSL could not make a certificate for a test");
}

std::string text_of(BIO* bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio, &data);
  return {data, static_cast<std::size_t>(size)};
}

void extend(X509* certificate, int kind, const char* value) {
  std::unique_ptr<X509_EXTENSION, decltype(&X509_EXTENSION_free)> extension(
      X509V3_EXT_conf_nid(nullptr, nullptr, kind, value), &X509_EXTENSION_free);
  need(extension && X509_add_ext(certificate, extension.get(), -1) == 1);
}

void set_name(X509_NAME* to, const std::string& name) {
  need(X509_NAME_add_entry_by_txt(to, "CN", MBSTRING_UTF8,
                                  reinterpret_cast<const unsigned char*>(name.c_str()), -1, -1, 0) == 1);
}

// Makes a certificate, signed by `authority`, or by itself if that is null.
Pem make(const std::string& name, long from_s, long until_s, const Pem* authority) {
  std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key(EVP_EC_gen("P-256"), &EVP_PKEY_free);
  std::unique_ptr<X509, decltype(&X509_free)> made(X509_new(), &X509_free);
  need(key && made);
  X509* certificate = made.get();
  X509_set_version(certificate, X509_VERSION_3);
  static long serial = 1;
  ASN1_INTEGER_set(X509_get_serialNumber(certificate), ++serial);
  X509_gmtime_adj(X509_getm_notBefore(certificate), from_s);
  X509_gmtime_adj(X509_getm_notAfter(certificate), until_s);
  X509_set_pubkey(certificate, key.get());
  set_name(X509_get_subject_name(certificate), name);
  extend(certificate, NID_basic_constraints, authority ? "CA:FALSE" : "critical,CA:TRUE");
  extend(certificate, NID_subject_alt_name, "DNS:localhost,IP:127.0.0.1,IP:::1");
  std::unique_ptr<BIO, decltype(&BIO_free)> out(BIO_new(BIO_s_mem()), &BIO_free);
  if (authority) {
    std::unique_ptr<BIO, decltype(&BIO_free)> of_it(BIO_new_mem_buf(authority->certificate.c_str(), -1),
                                                    &BIO_free);
    std::unique_ptr<BIO, decltype(&BIO_free)> its_key(BIO_new_mem_buf(authority->key.c_str(), -1), &BIO_free);
    std::unique_ptr<X509, decltype(&X509_free)> issuer(
        PEM_read_bio_X509(of_it.get(), nullptr, nullptr, nullptr), &X509_free);
    std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> signer(
        PEM_read_bio_PrivateKey(its_key.get(), nullptr, nullptr, nullptr), &EVP_PKEY_free);
    need(issuer && signer);
    X509_set_issuer_name(certificate, X509_get_subject_name(issuer.get()));
    need(X509_sign(certificate, signer.get(), EVP_sha256()) > 0);
  } else {
    X509_set_issuer_name(certificate, X509_get_subject_name(certificate));
    need(X509_sign(certificate, key.get(), EVP_sha256()) > 0);
  }
  need(PEM_write_bio_X509(out.get(), certificate) == 1);
  Pem pem{text_of(out.get()), {}};
  std::unique_ptr<BIO, decltype(&BIO_free)> key_out(BIO_new(BIO_s_mem()), &BIO_free);
  need(PEM_write_bio_PrivateKey(key_out.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr) == 1);
  pem.key = text_of(key_out.get());
  return pem;
}

protocol::TlsFiles write(const test::TempFiles& folder, const std::string& name, const Pem& pem) {
  const auto certificate = folder.write(name + ".pem", pem.certificate);
  const auto key = folder.write(name + ".key", pem.key);
  using std::filesystem::perms;
  std::filesystem::permissions(key, perms::owner_read | perms::owner_write);
  return {(folder.folder() / "ca.pem").string(), certificate.string(), key.string()};
}

}  // namespace

Certificates::Certificates() {
  const Pem authority = make("authority", -kDay_s, kDay_s, nullptr);
  authority_ = authority.certificate;
  authority_key_ = authority.key;
  folder_.write("ca.pem", authority_);
}

protocol::TlsFiles Certificates::files(const std::string& name, When when) const {
  const Pem authority{authority_, authority_key_};
  const bool expired = when == kExpired;
  const Pem pem = make(name, expired ? -2 * kDay_s : -kDay_s, expired ? -kDay_s : kDay_s, &authority);
  return write(folder_, name + (expired ? "_expired" : ""), pem);
}

protocol::TlsFiles Certificates::self_signed(const std::string& name) const {
  return write(folder_, name + "_alone", make(name, -kDay_s, kDay_s, nullptr));
}

}  // namespace visum::testing
