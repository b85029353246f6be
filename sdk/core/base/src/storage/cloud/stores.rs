//! Creates the object stores that environment variables describe.

use std::sync::Arc;

use object_store::ObjectStore;
use object_store::aws::{AmazonS3Builder, AmazonS3ConfigKey as S3Key};
use object_store::azure::{AzureConfigKey as AzKey, MicrosoftAzureBuilder};
use object_store::gcp::{GcpCredential, GoogleCloudStorageBuilder, GoogleConfigKey as GsKey};
use object_store::http::HttpBuilder;
use object_store::path::Path;
use object_store::{BackoffConfig, ClientConfigKey, RetryConfig, StaticCredentialProvider};

use super::log::Connector;
use crate::storage::location::{Scheme, Uri};
use crate::storage::{Settings, Variables};

/// Largest ratio of a pause to the previous pause.
const PAUSE_GROWTH: f64 = 6.0;

/// A store, the key in it, and whether requests are signed.
pub(crate) struct StoreAndKey {
    pub(crate) store: Arc<dyn ObjectStore>,
    pub(crate) key: Path,
    pub(crate) is_signed: bool,
}

/// The data from which a store is created.
pub(crate) struct StoreRequest<'a> {
    pub(crate) uri: &'a Uri,
    pub(crate) settings: &'a Settings,
    pub(crate) variables: &'a Variables,
    pub(crate) connector: Connector,
}

impl StoreRequest<'_> {
    /// Creates the store of a URI. No request is sent yet.
    ///
    /// # Errors
    /// If settings are missing or wrong. The sentence contains the names of variables but never
    /// their values.
    pub(crate) fn open(self) -> Result<StoreAndKey, String> {
        match self.uri.scheme {
            Scheme::S3 => self.s3(),
            Scheme::Gs => self.gs(),
            Scheme::Az => self.az(),
            Scheme::Http | Scheme::Https => self.web(),
        }
    }

    fn retry(&self) -> RetryConfig {
        RetryConfig {
            backoff: BackoffConfig {
                init_backoff: self.settings.first_pause,
                max_backoff: self.settings.longest_pause,
                base: PAUSE_GROWTH,
            },
            max_retries: self.settings.retries,
            retry_timeout: self.settings.total,
        }
    }

    fn key(&self) -> Result<Path, String> {
        Path::parse(&self.uri.path).map_err(|_| {
            "the key has an empty part, `.` or `..`, or ends with a slash; correct it".to_owned()
        })
    }

    fn s3(self) -> Result<StoreAndKey, String> {
        self.variables.check("AWS_")?;
        let mut builder = AmazonS3Builder::new();
        for (name, value) in self.variables.with_prefix("AWS_") {
            if let Ok(key) = name.to_ascii_lowercase().parse::<S3Key>() {
                builder = builder.with_config(key, value);
            }
        }
        let has = |key: &S3Key| builder.get_config_value(key).is_some();
        if has(&S3Key::AccessKeyId) != has(&S3Key::SecretAccessKey) {
            return Err("AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY belong together, and one is missing; set both".to_owned());
        }
        let endpoint = builder
            .get_config_value(&S3Key::S3Endpoint)
            .or_else(|| builder.get_config_value(&S3Key::Endpoint));
        let allow = builder.get_config_value(&S3Key::Client(ClientConfigKey::AllowHttp));
        if endpoint.is_some_and(|e| !e.starts_with("https://")) && allow.as_deref() != Some("true")
        {
            return Err("AWS_ENDPOINT_URL is not https://; for a server without TLS set AWS_ALLOW_HTTP=true".to_owned());
        }
        // Without any of these, the library would ask the metadata service of the machine.
        let is_signed = [
            S3Key::AccessKeyId,
            S3Key::WebIdentityTokenFile,
            S3Key::ContainerCredentialsRelativeUri,
            S3Key::ContainerCredentialsFullUri,
            S3Key::MetadataEndpoint,
        ]
        .iter()
        .any(has);
        let (key, retry) = (self.key()?, self.retry());
        let mut builder = builder
            .with_bucket_name(&self.uri.authority)
            .with_retry(retry)
            .with_http_connector(self.connector);
        if !is_signed {
            builder = builder.with_skip_signature(true);
        }
        let store = builder
            .build()
            .map_err(|_| "a variable of AWS_* is not valid; correct it".to_owned())?;
        Ok(StoreAndKey { store: Arc::new(store), key, is_signed })
    }

    fn gs(self) -> Result<StoreAndKey, String> {
        self.variables.check("GOOGLE_")?;
        let mut builder = GoogleCloudStorageBuilder::new();
        for (name, value) in self.variables.with_prefix("GOOGLE_") {
            if let Ok(key) = name.to_ascii_lowercase().parse::<GsKey>() {
                builder = builder.with_config(key, value);
            }
        }
        let is_signed = [
            GsKey::ServiceAccount,
            GsKey::ServiceAccountKey,
            GsKey::ApplicationCredentials,
            GsKey::BearerToken,
        ]
        .iter()
        .any(|key| builder.get_config_value(key).is_some());
        let (key, retry) = (self.key()?, self.retry());
        let mut builder = builder
            .with_bucket_name(&self.uri.authority)
            .with_retry(retry)
            .with_http_connector(self.connector);
        if !is_signed {
            // An explicit empty credential keeps the library from looking for others.
            let none = GcpCredential { bearer: String::new() };
            builder = builder
                .with_credentials(Arc::new(StaticCredentialProvider::new(none)))
                .with_skip_signature(true);
        }
        let store = builder.build().map_err(|_| {
            "a variable of GOOGLE_* is not valid, or the file that it names; correct it".to_owned()
        })?;
        Ok(StoreAndKey { store: Arc::new(store), key, is_signed })
    }

    fn az(self) -> Result<StoreAndKey, String> {
        self.variables.check("AZURE_")?;
        let mut builder = MicrosoftAzureBuilder::new();
        for (name, value) in self.variables.with_prefix("AZURE_") {
            if let Ok(key) = name.to_ascii_lowercase().parse::<AzKey>() {
                builder = builder.with_config(key, value);
            }
        }
        let has = |key: &AzKey| builder.get_config_value(key).is_some();
        let is_emulated = builder.get_config_value(&AzKey::UseEmulator).as_deref() == Some("true");
        if !has(&AzKey::AccountName) && !is_emulated {
            return Err(
                "AZURE_STORAGE_ACCOUNT_NAME is not set; set it to the account of the container"
                    .to_owned(),
            );
        }
        let given = [
            AzKey::AccessKey,
            AzKey::SasKey,
            AzKey::Token,
            AzKey::ClientSecret,
            AzKey::FederatedTokenFile,
            AzKey::MsiEndpoint,
        ];
        let is_signed = is_emulated || given.iter().any(has);
        let (key, retry) = (self.key()?, self.retry());
        let mut builder = builder
            .with_container_name(&self.uri.authority)
            .with_retry(retry)
            .with_http_connector(self.connector);
        if !is_signed {
            builder = builder.with_skip_signature(true);
        }
        let store = builder.build();
        let store =
            store.map_err(|_| "a variable of AZURE_* is not valid; correct it".to_owned())?;
        Ok(StoreAndKey { store: Arc::new(store), key, is_signed })
    }

    /// Creates a store for a web server. The store's address is the whole URL and its key is empty,
    /// so that escapes and query stay unchanged.
    fn web(self) -> Result<StoreAndKey, String> {
        let Uri { authority, path, .. } = self.uri;
        let query = self.uri.query.as_ref().map(|query| format!("?{query}"));
        let url =
            format!("{}://{authority}/{path}{}", self.uri.scheme.name(), query.unwrap_or_default());
        let wrong = || "it is not a URL; percent-encode what cannot stand in one".to_owned();
        let url: reqwest::Url = url.parse().map_err(|_| wrong())?;
        let retry = self.retry();
        let store = HttpBuilder::new()
            .with_url(url.to_string())
            .with_retry(retry)
            .with_http_connector(self.connector)
            .build()
            .map_err(|_| wrong())?;
        Ok(StoreAndKey { store: Arc::new(store), key: Path::default(), is_signed: false })
    }
}
