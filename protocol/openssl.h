// OpenSSL's functions, from its shared library. It is loaded for the first TlsContext: most runs have no TLS,
// and each program of a run would load it. Only tls.cc and openssl.cc include this.
#pragma once

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#define VISUM_OPENSSL_FUNCTIONS(F)      \
  F(ASN1_STRING_to_UTF8)                \
  F(BIO_ctrl_pending)                   \
  F(BIO_new)                            \
  F(BIO_read)                           \
  F(BIO_s_mem)                          \
  F(BIO_write)                          \
  F(CRYPTO_free)                        \
  F(ERR_clear_error)                    \
  F(ERR_peek_error)                     \
  F(ERR_peek_last_error)                \
  F(ERR_reason_error_string)            \
  F(SSL_CTX_ctrl)                       \
  F(SSL_CTX_free)                       \
  F(SSL_CTX_load_verify_file)           \
  F(SSL_CTX_new)                        \
  F(SSL_CTX_set_num_tickets)            \
  F(SSL_CTX_set_verify)                 \
  F(SSL_CTX_use_PrivateKey_file)        \
  F(SSL_CTX_use_certificate_chain_file) \
  F(SSL_alert_desc_string_long)         \
  F(SSL_ctrl)                           \
  F(SSL_do_handshake)                   \
  F(SSL_free)                           \
  F(SSL_get0_param)                     \
  F(SSL_get0_peer_certificate)          \
  F(SSL_get_error)                      \
  F(SSL_get_verify_result)              \
  F(SSL_is_init_finished)               \
  F(SSL_new)                            \
  F(SSL_read_ex)                        \
  F(SSL_set1_host)                      \
  F(SSL_set_accept_state)               \
  F(SSL_set_bio)                        \
  F(SSL_set_connect_state)              \
  F(SSL_shutdown)                       \
  F(SSL_write_ex)                       \
  F(TLS_client_method)                  \
  F(TLS_server_method)                  \
  F(X509_NAME_ENTRY_get_data)           \
  F(X509_NAME_get_entry)                \
  F(X509_NAME_get_index_by_NID)         \
  F(X509_VERIFY_PARAM_set1_ip_asc)      \
  F(X509_get_subject_name)              \
  F(X509_verify_cert_error_string)

namespace visum::protocol {

// The members have the names of the functions.
struct OpenSsl {
#define VISUM_OPENSSL_MEMBER(name) decltype(&::name) name;
  VISUM_OPENSSL_FUNCTIONS(VISUM_OPENSSL_MEMBER)
#undef VISUM_OPENSSL_MEMBER
};

// Loads the library at the first call; it stays until the process ends. Any thread. Throws std::runtime_error
// with the loader's reason where the library or one of the functions is missing.
const OpenSsl& openssl();

}  // namespace visum::protocol
